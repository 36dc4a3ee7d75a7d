#include <fmt/core.h>

#include "engine/base/progress.h"
#include "pipeline/acquire/import/background.h"
#include "pipeline/acquire/record/camera_source.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr double default_rate_hz = 30.0;

class ImageReplay : public CameraSource {
 public:
  ImageReplay(const std::filesystem::path& path, const CameraSourceOptions& options, double start_s)
      : source_(
            open_source(path, {.color_topic = {}, .depth_topic = {}, .rate_hz = options.rate_hz})),
        camera_(describe_camera(path, source_, options.folder)),
        speed_(options.replay_speed),
        start_s_(start_s),
        replay_start_s_(monotonic_s()),
        first_s_(source_.color.images.front().host_time_s) {
    if (!source_.depth.images.empty())
      first_s_ = std::min(first_s_, source_.depth.images.front().host_time_s);
  }

  void describe(CameraInfo& camera) const override {
    camera = camera_.info;
    camera.rate_hz = rate_of(host_times_s(source_.color), default_rate_hz);
  }

  bool step(const RecordSink& sink) override {
    const bool has_color = color_ < source_.color.images.size(),
               has_depth = depth_ < source_.depth.images.size();
    if (!has_color && !has_depth) return false;
    const bool is_color = has_color && (!has_depth || source_.color.images[color_].host_time_s <=
                                                          source_.depth.images[depth_].host_time_s);
    const SourceImage& image =
        is_color ? source_.color.images[color_] : source_.depth.images[depth_];
    if (!wait_until(image.host_time_s)) return true;
    const std::size_t index = is_color ? color_++ : depth_++;
    try {
      pass_on(sink, is_color, index, image);
    } catch (const std::exception& error) {
      Progress::warn(fmt::format("skipped {}: {}", image.name, error.what()));
    }
    return true;
  }

 private:
  /// Waits until an image is due, but not for long. Returns whether it is due.
  bool wait_until(double host_time_s) const {
    return speed_ == 0.0 || wait_for_time(replay_start_s_ + (host_time_s - first_s_) / speed_);
  }

  void pass_on(const RecordSink& sink, bool is_color, std::size_t index, const SourceImage& image) {
    const SourceStream& stream = is_color ? source_.color : source_.depth;
    const ImageFormat& format = is_color ? camera_.color : camera_.depth;
    const cv::Mat pixels = stream.read(index);
    if (pixels.size() != format.size || pixels.type() != format.type)
      throw std::runtime_error("another size or type than the first image");
    const FrameStamp stamp{index, replay_start_s_ - start_s_ + image.host_time_s - first_s_,
                           image.device_time_s - first_s_};
    if (is_color) {
      const auto values = rgb_values(pixels);
      sink(RecordKind::color_image, to_payload(stamp, std::span(values)));
    } else {
      const auto values = camera_.depth_scale.counts(pixels);
      sink(RecordKind::depth_image, to_payload(stamp, std::span(values)));
    }
  }

  ImportSource source_;
  SourceCamera camera_;
  double speed_, start_s_, replay_start_s_, first_s_;
  std::size_t color_ = 0, depth_ = 0;  ///< next images
};

}  // namespace

std::unique_ptr<CameraSource> open_image_replay(const std::filesystem::path& path,
                                                const CameraSourceOptions& options,
                                                double start_s) {
  return std::make_unique<ImageReplay>(path, options, start_s);
}

}  // namespace touchtrace
