#include "pipeline/acquire/import/stream_copy.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/progress.h"
#include "pipeline/acquire/import/images/frame_numbers.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_reported = 5;

}  // namespace

StreamCopy::StreamCopy(const SourceStream& stream, const ImageFormat& format, double clock_start_s,
                       Append append)
    : stream_(stream),
      format_(format),
      clock_start_s_(clock_start_s),
      append_(std::move(append)),
      frame_counter_(frame_counter(stream.frame_numbers)) {}

void StreamCopy::copy_next() {
  const std::size_t index = next_++;
  cv::Mat image;
  try {
    image = stream_.read(index);
  } catch (const std::exception& error) {
    return skip(error.what());
  }
  if (image.size() != format_.size)
    return skip(fmt::format("{}x{} pixels instead of {}x{}", image.cols, image.rows,
                            format_.size.width, format_.size.height));
  if (image.type() != format_.type) return skip("another type of pixels");
  append_(image);
  num_repeated_ += !last_.empty() && cv::norm(image, last_, cv::NORM_INF) == 0.0;
  image.copyTo(last_);
  copied_.emplace(index, copied_.size());
}

void StreamCopy::skip(const std::string& fault) {
  if (num_skipped() <= max_reported)
    Progress::warn(fmt::format("skipped {}: {}", stream_.images[next_ - 1].name, fault));
  if (num_skipped() == max_reported + 1) Progress::warn("skipped further images");
}

CameraTimes StreamCopy::times() const {
  CameraTimes times;
  for (const auto& [source, unused] : copied_) {
    const SourceImage& image = stream_.images[source];
    times.sequence.push_back(frame_counter_.empty() ? source : frame_counter_[source]);
    times.host_time_s.push_back(image.host_time_s - clock_start_s_);
    const bool is_unix = image.device_time_s > min_unix_s;
    times.device_time_s.push_back(image.device_time_s - (is_unix ? clock_start_s_ : 0.0));
  }
  if (!std::ranges::is_sorted(times.device_time_s)) {
    Progress::warn("the camera's stamps run backward; times of arrival replace them");
    times.device_time_s = times.host_time_s;
  }
  return times;
}

}  // namespace touchtrace
