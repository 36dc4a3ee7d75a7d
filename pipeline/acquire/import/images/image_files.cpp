#include "pipeline/acquire/import/images/image_files.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/import/formats/matlab_file.h"
#include "pipeline/acquire/import/formats/numpy_file.h"
#include "pipeline/acquire/import/images/frame_numbers.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

cv::Mat read_image(const fs::path& path, int flags) {
  cv::Mat image = decode_image(path, flags | cv::IMREAD_IGNORE_ORIENTATION);
  if (image.empty()) throw std::runtime_error("not a readable image");
  return image;
}

cv::Mat read_color(const fs::path& path) { return read_image(path, cv::IMREAD_COLOR); }

cv::Mat read_depth(const fs::path& path) {
  if (is_numpy_file(path)) return to_depth(read_numpy_array(path));
  if (is_matlab_file(path)) return read_matlab_depth(path);
  const cv::Mat image = read_image(path, cv::IMREAD_UNCHANGED);
  if (image.type() != CV_16UC1 && image.type() != CV_32FC1)
    throw std::runtime_error(fmt::format("{} channels of {} bits instead of one of 16",
                                         image.channels(), 8 * image.elemSize1()));
  return image;
}

SourceStream stream(std::vector<StampedFile> files, cv::Mat (*read)(const fs::path&)) {
  SourceStream result;
  result.frame_numbers = frame_numbers(files);
  for (const StampedFile& file : files)
    result.images.push_back({file.path.string(), file.time_s, file.time_s});
  result.read = [files = std::move(files), read](std::size_t i) { return read(files[i].path); };
  return result;
}

}  // namespace

SourceStream color_file_stream(std::vector<StampedFile> files) {
  return stream(std::move(files), read_color);
}

SourceStream depth_file_stream(std::vector<StampedFile> files) {
  return stream(std::move(files), read_depth);
}

std::vector<fs::path> depth_array_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && (is_numpy_file(entry.path()) || is_matlab_file(entry.path())))
      files.push_back(entry.path());
  return files;
}

}  // namespace touchtrace
