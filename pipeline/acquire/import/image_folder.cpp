#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/import/image_files.h"
#include "pipeline/acquire/import/image_times.h"
#include "pipeline/acquire/import/numpy_file.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array color_names{"rgb", "color", "colour", "images"};
constexpr std::array depth_names{"depth", "depths"};

std::optional<fs::path> find_folder(const fs::path& folder, std::span<const char* const> names) {
  for (const char* name : names)
    if (fs::is_directory(folder / name)) return folder / name;
  return std::nullopt;
}

std::vector<fs::path> array_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_numpy_file(entry.path())) files.push_back(entry.path());
  return files;
}

std::vector<StampedFile> images_of(const fs::path& folder, std::vector<fs::path> images,
                                   double rate_hz) {
  if (images.empty())
    throw data_error(fmt::format("{} has no images", folder.string()),
                     "put PNG or JPEG images into it; depth also as .npy");
  return stamped_images(folder, std::move(images), rate_hz);
}

SourceStream open_depth(const fs::path& folder, double rate_hz) {
  auto images = images_in_folder(folder);
  if (images.empty()) images = array_files(folder);
  return depth_file_stream(images_of(folder, std::move(images), rate_hz));
}

}  // namespace

bool is_image_folder(const fs::path& folder) {
  return find_folder(folder, color_names).has_value();
}

ImportSource open_image_folder(const fs::path& folder, const SourceOptions& options) {
  const fs::path colors = *find_folder(folder, color_names);
  ImportSource source{
      .color = color_file_stream(images_of(colors, images_in_folder(colors), options.rate_hz)),
      .depth = {}};
  if (const auto depths = find_folder(folder, depth_names))
    source.depth = open_depth(*depths, options.rate_hz);
  else
    Progress::report(
        fmt::format("warning: {} has no folder 'depth'; only colour is imported", folder.string()));
  return source;
}

}  // namespace touchtrace
