#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/import/formats/name_words.h"
#include "pipeline/acquire/import/images/image_files.h"
#include "pipeline/acquire/import/images/image_times.h"
#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Image files whose names differ in their last number only, by that name.
using NamedImages = std::map<std::string, std::vector<fs::path>>;

struct PairedImages {
  NamedImages color, depth;
};

/// Name with '#' for its last number: "depth_12.png" and "depth_13.png" become "depth_#.png".
std::string series_name(const fs::path& file) {
  std::string name = file.filename();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::size_t stem = file.stem().string().size();
  const auto last = name.find_last_of("0123456789", stem - 1);
  if (last == std::string::npos) return name;
  std::size_t first = last;
  while (first > 0 && (is_digit(name[first - 1]) ||
                       (name[first - 1] == '.' && first > 1 && is_digit(name[first - 2]))))
    --first;
  return name.replace(first, last + 1 - first, "#");
}

PairedImages find_images(const fs::path& folder) {
  PairedImages found;
  for (const fs::path& file : images_in_folder(folder)) {
    const std::string stem = file.stem();
    if (names_other_image(stem)) continue;
    (names_depth(stem) ? found.depth : found.color)[series_name(file)].push_back(file);
  }
  for (const fs::path& file : depth_array_files(folder))
    found.depth[series_name(file)].push_back(file);
  return found;
}

/// The series of a kind. If there are several, the one whose name says so.
const std::vector<fs::path>& choose_series(const fs::path& folder, const NamedImages& all,
                                           bool (*is_named)(std::string_view), const char* kind) {
  std::vector<std::string> names;
  const std::vector<fs::path>* chosen = nullptr;
  for (const auto& [name, files] : all)
    if (all.size() == 1 || is_named(name)) names.push_back(name), chosen = &files;
  if (names.size() == 1) return *chosen;
  if (names.empty())
    for (const auto& [name, files] : all) names.push_back(name);
  throw data_error(fmt::format("{} has several series of {} images: {}", folder.string(), kind,
                               comma_separated(names)),
                   "move one series of colour images to a folder rgb, its depth to a folder depth");
}

}  // namespace

bool is_paired_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) return false;
  const PairedImages found = find_images(folder);
  return !found.color.empty() && !found.depth.empty();
}

ImportSource open_paired_folder(const fs::path& folder, const SourceOptions& options) {
  const PairedImages found = find_images(folder);
  const auto& colors = choose_series(folder, found.color, names_color, "colour");
  const auto& depths = choose_series(folder, found.depth, names_registered_depth, "depth");
  ImportSource source{.color = color_file_stream(stamped_images(folder, colors, options.rate_hz)),
                      .depth = depth_file_stream(stamped_images(folder, depths, options.rate_hz))};
  if (names_registered_depth(depths.front().stem().string())) source.is_registered = true;
  return source;
}

}  // namespace touchtrace
