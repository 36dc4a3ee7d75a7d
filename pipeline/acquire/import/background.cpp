#include "pipeline/acquire/import/background.h"

#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_background = 100;

cv::Mat read_format(const SourceStream& stream, std::size_t index, const ImageFormat& format) {
  const std::string& name = stream.images[index].name;
  try {
    cv::Mat image = stream.read(index);
    if (image.size() == format.size && image.type() == format.type) return image;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read background image {}: {}", name, error.what()),
                     "remove it");
  }
  throw data_error(fmt::format("background image {} has another size or type of pixels", name),
                   "give images of the same camera and settings");
}

}  // namespace

std::vector<std::uint8_t> rgb_values(const cv::Mat& bgr) {
  std::vector<std::uint8_t> values(3 * bgr.total());
  cv::Mat rgb(bgr.size(), CV_8UC3, values.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return values;
}

FrameRange parse_frame_range(const std::string& text) {
  const auto parts = split_text(text, ':');
  FrameRange range;
  if (parts.size() == 2 && parse_whole(parts[0], range.first) &&
      parse_whole(parts[1], range.last) && range.first <= range.last)
    return range;
  throw usage_error(fmt::format("'{}' is not a range of frames", text),
                    "give the first and the last one, e.g. --background-frames 0:20");
}

void append_background(RecordingWriter& writer, const ImportSource& source,
                       const SourceCamera& camera, FrameRange range) {
  if (range.last >= source.depth.images.size())
    throw data_error(fmt::format("background frame {} does not exist: there are {} depth images",
                                 range.last, source.depth.images.size()),
                     "frames are counted from 0");
  const std::size_t step = (range.last - range.first) / max_background + 1;
  for (std::size_t i = range.first; i <= range.last; i += step) {
    const cv::Mat depth = read_format(source.depth, i, camera.depth);
    const auto color = nearest_image(source.color, source.depth.images[i].host_time_s);
    writer.append_background({rgb_values(read_format(source.color, color, camera.color)),
                              camera.depth_scale.counts(depth)});
  }
}

}  // namespace touchtrace
