#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/import/formats/name_words.h"
#include "pipeline/acquire/import/images/image_files.h"
#include "pipeline/acquire/import/images/image_times.h"
#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array color_names{"rgb", "color", "colour", "images"};
constexpr std::array depth_names{"depth", "depths"};
constexpr std::array registered_names{"aligned_depth"};

/// Folder with one of the names or, else, the only one whose name has such words. Throws data_error
/// if there are several.
std::optional<fs::path> find_folder(const fs::path& folder, std::span<const char* const> names,
                                    bool (*is_named)(std::string_view)) {
  for (const char* name : names)
    if (fs::is_directory(folder / name)) return folder / name;
  std::vector<fs::path> found;
  std::vector<std::string> listed;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (!entry.is_directory() || !is_named(name) || names_other_image(name)) continue;
    found.push_back(entry.path()), listed.push_back(name);
  }
  std::ranges::sort(listed);
  if (found.size() > 1)
    throw data_error(fmt::format("{} has several folders of one kind of images: {}",
                                 folder.string(), comma_separated(listed)),
                     fmt::format("name the right one '{}'", names[0]));
  return found.empty() ? std::nullopt : std::optional(found[0]);
}

bool has_folder(const fs::path& folder, bool (*is_named)(std::string_view)) {
  return fs::is_directory(folder) &&
         std::ranges::any_of(fs::directory_iterator(folder), [&](const fs::directory_entry& entry) {
           const std::string name = entry.path().filename();
           return entry.is_directory() && is_named(name) && !names_other_image(name);
         });
}

bool has_file(const fs::path& folder, const char* extension) {
  return std::ranges::any_of(fs::directory_iterator(folder), [&](const auto& entry) {
    return entry.path().extension() == extension;
  });
}

/// Conversion of depth images to arrays in metres.
std::string exr_hint(const fs::path& folder) {
  return fmt::format(
      "convert depth to .npy, in metres, with python3-opencv of Debian or opencv-python 4: "
      "OPENCV_IO_ENABLE_OPENEXR=1 python3 -c \"import cv2, glob, "
      "numpy; [numpy.save(f[:-4], cv2.imread(f, cv2.IMREAD_ANYDEPTH) + 0) for f in "
      "glob.glob('{}/*.exr')]\"",
      folder.string());
}

std::vector<StampedFile> images_of(const fs::path& folder, std::vector<fs::path> images,
                                   double rate_hz) {
  if (images.empty() && has_file(folder, ".exr"))
    throw data_error(
        fmt::format("the images in {} are OpenEXR, which is not read", folder.string()),
        exr_hint(folder));
  if (images.empty())
    throw data_error(
        fmt::format("{} has no images", folder.string()),
        "put PNG, JPEG or TIFF images into it; depth also as .npy or .mat; colour arrays are read "
        "from one .npz with color, depth and time_s");
  return stamped_images(folder, std::move(images), rate_hz);
}

SourceStream open_depth(const fs::path& folder, double rate_hz) {
  auto images = images_in_folder(folder);
  if (images.empty()) images = depth_array_files(folder);
  return depth_file_stream(images_of(folder, std::move(images), rate_hz));
}

}  // namespace

bool is_image_folder(const fs::path& folder) {
  const auto is_there = [&](const char* name) { return fs::is_directory(folder / name); };
  return std::ranges::any_of(color_names, is_there) ||
         (has_folder(folder, names_depth) && has_folder(folder, names_color));
}

ImportSource open_image_folder(const fs::path& folder, const SourceOptions& options) {
  const fs::path colors = find_folder(folder, color_names, names_color).value();
  ImportSource source{
      .color = color_file_stream(images_of(colors, images_in_folder(colors), options.rate_hz)),
      .depth = {}};
  auto depths = find_folder(folder, registered_names, names_registered_depth);
  if (depths) source.is_registered = true;
  if (!depths) depths = find_folder(folder, depth_names, names_depth);
  if (depths)
    source.depth = open_depth(*depths, options.rate_hz);
  else
    Progress::warn(
        fmt::format("{} has no folder 'depth'; only colour is imported", folder.string()));
  return source;
}

}  // namespace touchtrace
