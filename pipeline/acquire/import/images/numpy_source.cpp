#include <fmt/core.h>

#include <memory>
#include <opencv2/imgproc.hpp>

#include "engine/base/error.h"
#include "pipeline/acquire/import/formats/numpy_file.h"
#include "pipeline/acquire/import/source/source.h"
#include "pipeline/acquire/stamp_unit.h"
#include "pipeline/acquire/time_order.h"

namespace touchtrace {
namespace {

using Arrays = std::map<std::string, NumpyArray>;

const NumpyArray* find_array(const Arrays& arrays, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto found = arrays.find(name); found != arrays.end()) return &found->second;
  return nullptr;
}

/// Requires [frames, height, width] or, of colour, [frames, height, width, 3] bytes.
void require_images(const NumpyArray* array, const char* name, std::size_t dimensions) {
  const bool is_good = array && array->shape.size() == dimensions && array->size() > 0 &&
                       std::max(array->shape[1], array->shape[2]) <= max_array_image_size &&
                       (dimensions == 3 || (array->shape[3] == 3 && array->type == "u1"));
  if (!is_good)
    throw data_error(fmt::format("the archive has no array {} of images", name),
                     "color is uint8 [frames, height, width, 3], red first; depth is "
                     "[frames, height, width], integer counts or float metres");
}

cv::Mat color_image(const NumpyArray& images, std::size_t index) {
  const auto& shape = images.shape;
  const cv::Mat rgb(static_cast<int>(shape[1]), static_cast<int>(shape[2]), CV_8UC3,
                    const_cast<char*>(images.data.data()) + index * shape[1] * shape[2] * 3);
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

cv::Mat depth_image(const NumpyArray& images, std::size_t index) {
  const std::size_t bytes = images.data.size() / images.shape[0];
  return to_depth({{images.shape[1], images.shape[2]},
                   images.type,
                   images.data.substr(index * bytes, bytes),
                   0.0});
}

/// Times of the images of one array [s].
std::vector<double> times_of(const char* name, std::size_t count, const NumpyArray* times,
                             double rate_hz) {
  if (times ? times->size() != count : rate_hz <= 0.0)
    throw data_error(fmt::format("the archive has no time_s with {} times of {}", count, name),
                     "add time_s [s], or give --rate HZ");
  std::vector<double> times_s;
  for (std::size_t i = 0; i < count; ++i)
    times_s.push_back(times ? times->at(i) : static_cast<double>(i) / rate_hz);
  return times ? in_seconds(std::move(times_s), fmt::format("times of {}", name)) : times_s;
}

/// Stream of the images in order of their times. `image`: reads one by its index in the array.
template <class Image>
SourceStream stream_of(const char* name, const std::vector<double>& times_s, Image&& image) {
  const auto order = time_order(times_s, name);
  SourceStream stream;
  for (const std::size_t i : order)
    stream.images.push_back({fmt::format("{} {}", name, i), times_s[i], times_s[i]});
  stream.read = [order, image](std::size_t i) { return image(order[i]); };
  return stream;
}

}  // namespace

bool is_numpy_archive(const std::filesystem::path& file) {
  return std::filesystem::is_regular_file(file) && file.extension() == ".npz";
}

ImportSource open_numpy_source(const std::filesystem::path& file, const SourceOptions& options) {
  const auto arrays = std::make_shared<const Arrays>(read_numpy_archive(file));
  const NumpyArray* color = find_array(*arrays, {"color", "colour", "rgb"});
  const NumpyArray* depth = find_array(*arrays, {"depth"});
  const NumpyArray* times = find_array(*arrays, {"time_s", "times", "timestamps"});
  require_images(color, "color", 4);
  require_images(depth, "depth", 3);
  return {.color = stream_of("color", times_of("color", color->shape[0], times, options.rate_hz),
                             [arrays, color](std::size_t i) { return color_image(*color, i); }),
          .depth = stream_of("depth", times_of("depth", depth->shape[0], times, options.rate_hz),
                             [arrays, depth](std::size_t i) { return depth_image(*depth, i); })};
}

}  // namespace touchtrace
