#include "pipeline/acquire/tum_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/stamp_unit.h"
#include "pipeline/acquire/time_order.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr double max_time_difference_s = 0.02;
constexpr std::size_t max_pairs = 80;

bool leaves_folder(const fs::path& path) {
  return path.is_absolute() || path.empty() ||
         std::ranges::find(path, fs::path("..")) != path.end();
}

void convert_to_seconds(std::vector<StampedFile>& files, const std::string& list) {
  std::vector<double> stamps;
  for (const StampedFile& file : files) stamps.push_back(file.time_s);
  const auto times_s = in_seconds(std::move(stamps), list);
  for (std::size_t i = 0; i < files.size(); ++i) files[i].time_s = times_s[i];
}

}  // namespace

std::vector<StampedFile> read_tum_list(const fs::path& folder, const char* list) {
  std::istringstream lines(read_file(folder / list));
  std::vector<StampedFile> files;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream words(line);
    StampedFile file;
    std::string path;
    if (!(words >> file.time_s >> path) || !std::isfinite(file.time_s) || leaves_folder(path))
      throw data_error(
          fmt::format("line {} of {} is not `timestamp path`", number, (folder / list).string()),
          "give a folder in the format of the TUM RGB-D benchmark");
    file.path = folder / path;
    files.push_back(std::move(file));
  }
  convert_to_seconds(files, (folder / list).string());
  return in_time_order(std::move(files), &StampedFile::time_s, (folder / list).string());
}

bool is_tum_folder(const fs::path& folder) {
  return fs::is_regular_file(folder / "rgb.txt") && fs::is_regular_file(folder / "depth.txt");
}

std::vector<TumPair> read_tum_pairs(const fs::path& folder) {
  const auto colors = read_tum_list(folder, "rgb.txt"), depths = read_tum_list(folder, "depth.txt");
  std::vector<TumPair> pairs;
  auto next = depths.begin();
  for (const StampedFile& color : colors) {
    const auto distance_s = [&](const StampedFile& depth) {
      return std::abs(depth.time_s - color.time_s);
    };
    while (next != depths.end() && next + 1 != depths.end() &&
           distance_s(next[1]) <= distance_s(*next))
      ++next;
    if (next == depths.end() || distance_s(*next) > max_time_difference_s) continue;
    pairs.push_back({color.time_s, next->time_s, color.path, next->path});
    ++next;
  }
  if (pairs.empty())
    throw data_error(fmt::format("{} has no colour image with a depth image within {:.0f} ms",
                                 folder.string(), 1e3 * max_time_difference_s),
                     "give a folder in the format of the TUM RGB-D benchmark");
  return pairs;
}

std::vector<TumPair> select_tum_pairs(const std::vector<TumPair>& all) {
  if (all.size() <= max_pairs) return all;
  std::vector<TumPair> selected;
  constexpr std::size_t num_groups = max_pairs / 2;
  for (std::size_t i = 0; i < num_groups; ++i) {
    const std::size_t first = i * (all.size() - 2) / (num_groups - 1);
    selected.insert(selected.end(), {all[first], all[first + 1]});
  }
  return selected;
}

std::vector<fs::path> tum_files(const fs::path& folder) {
  std::vector<fs::path> files{folder / "rgb.txt", folder / "depth.txt"};
  for (const TumPair& pair : select_tum_pairs(read_tum_pairs(folder)))
    files.insert(files.end(), {pair.color, pair.depth});
  return files;
}

}  // namespace touchtrace
