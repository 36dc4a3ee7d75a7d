#include <fmt/core.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array image_extensions{".png", ".jpg",  ".jpeg", ".bmp",
                                      ".tif", ".tiff", ".pgm",  ".ppm"};

bool is_image(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return fs::is_regular_file(path) &&
         std::ranges::find(image_extensions, extension) != image_extensions.end();
}

std::vector<fs::path> matches(const std::string& pattern) {
  glob_t found{};
  const std::unique_ptr<glob_t, decltype(&globfree)> release(&found, &globfree);
  std::vector<fs::path> paths;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  return paths;
}

}  // namespace

GreyImage read_grey(const fs::path& path) {
  const cv::Mat pixels = decode_image(path, cv::IMREAD_GRAYSCALE);
  if (pixels.empty())
    throw data_error(fmt::format("{} is not a readable image", path.string()),
                     "remove it from the folder, or give a pattern that excludes it");
  return {pixels.cols, pixels.rows, {pixels.datastart, pixels.dataend}};
}

void require_same_size(const BoardObservations& observations, const GreyImage& image,
                       const fs::path& path) {
  if (image.width != observations.width || image.height != observations.height)
    throw data_error(
        fmt::format("{} has {}x{} pixels, the previous images have {}x{}", path.string(),
                    image.width, image.height, observations.width, observations.height),
        "give images of one camera and one size");
}

std::vector<fs::path> image_files(const std::string& folder_or_pattern) {
  if (is_tum_folder(folder_or_pattern)) return tum_files(folder_or_pattern);
  const bool folder = fs::is_directory(folder_or_pattern);
  auto files = matches(folder ? folder_or_pattern + "/*" : folder_or_pattern);
  if (folder) std::erase_if(files, [](const fs::path& path) { return !is_image(path); });
  if (files.empty())
    throw data_error(fmt::format("no images in '{}'", folder_or_pattern),
                     "give a folder, or a quoted pattern such as 'photos/left*.jpg'");
  return files;
}

BoardObservations board_views_from_images(const std::string& folder_or_pattern,
                                          const Chessboard& board) {
  BoardObservations observations;
  observations.board = board;
  const auto files = image_files(folder_or_pattern);
  Progress progress("detecting the board", files.size());
  for (const auto& path : files) {
    const GreyImage image = read_grey(path);
    if (observations.width == 0)
      observations.width = image.width, observations.height = image.height;
    require_same_size(observations, image, path);
    add_view(observations, path.filename().string(), image);
    progress.advance();
  }
  return observations;
}

}  // namespace touchtrace
