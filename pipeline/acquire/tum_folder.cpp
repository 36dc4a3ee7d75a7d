#include "pipeline/acquire/tum_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr double widest_gap_s = 0.02;
constexpr std::size_t most_frames = 80;

struct Stamped {
  double time_s;
  fs::path path;
};

bool leads_out(const fs::path& path) {
  return path.is_absolute() || path.empty() ||
         std::ranges::find(path, fs::path("..")) != path.end();
}

std::vector<Stamped> stamped_files(const fs::path& folder, const char* list) {
  std::istringstream lines(read_file(folder / list));
  std::vector<Stamped> files;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream words(line);
    Stamped file;
    std::string path;
    if (!(words >> file.time_s >> path) || !std::isfinite(file.time_s) || leads_out(path))
      throw data_error(
          fmt::format("line {} of {} is not `timestamp path`", number, (folder / list).string()),
          "give a folder as the TUM RGB-D benchmark has them");
    file.path = folder / path;
    files.push_back(std::move(file));
  }
  std::ranges::stable_sort(files, {}, &Stamped::time_s);
  return files;
}

}  // namespace

bool is_tum_folder(const fs::path& folder) {
  return fs::is_regular_file(folder / "rgb.txt") && fs::is_regular_file(folder / "depth.txt");
}

std::vector<TumPair> tum_pairs(const fs::path& folder) {
  const auto colors = stamped_files(folder, "rgb.txt"), depths = stamped_files(folder, "depth.txt");
  std::vector<TumPair> pairs;
  auto next = depths.begin();
  for (const Stamped& color : colors) {
    const auto distance_s = [&](const Stamped& depth) {
      return std::abs(depth.time_s - color.time_s);
    };
    while (next != depths.end() && next + 1 != depths.end() &&
           distance_s(next[1]) <= distance_s(*next))
      ++next;
    if (next == depths.end() || distance_s(*next) > widest_gap_s) continue;
    pairs.push_back({color.time_s, next->time_s, color.path, next->path});
    ++next;
  }
  if (pairs.empty())
    throw data_error(fmt::format("{} has no colour image with a depth image within {:.0f} ms",
                                 folder.string(), 1e3 * widest_gap_s),
                     "give a folder as the TUM RGB-D benchmark has them");
  return pairs;
}

std::vector<TumPair> chosen_pairs(const std::vector<TumPair>& all) {
  if (all.size() <= most_frames) return all;
  std::vector<TumPair> chosen;
  constexpr std::size_t places = most_frames / 2;
  for (std::size_t place = 0; place < places; ++place) {
    const std::size_t first = place * (all.size() - 2) / (places - 1);
    chosen.insert(chosen.end(), {all[first], all[first + 1]});
  }
  return chosen;
}

std::vector<fs::path> tum_files(const fs::path& folder) {
  std::vector<fs::path> files{folder / "rgb.txt", folder / "depth.txt"};
  for (const TumPair& pair : chosen_pairs(tum_pairs(folder)))
    files.insert(files.end(), {pair.color, pair.depth});
  return files;
}

}  // namespace touchtrace
