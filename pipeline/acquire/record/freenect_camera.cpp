#include "engine/base/error.h"
#include "pipeline/acquire/record/camera_source.h"

#ifdef TOUCHTRACE_FREENECT
#include <fmt/core.h>
#include <libfreenect.h>
#include <libusb.h>

#include <cmath>

#include "engine/base/progress.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

constexpr int image_width = 640, image_height = 480;
constexpr std::size_t num_pixels = image_width * image_height;
constexpr double nominal_rate_hz = 30.0, ticks_per_s = 60e6;
constexpr int event_timeout_us = 100'000;

/// Number of the next image of one stream. The device does not count images: lost ones are found by
/// the stamps.
class ImageCounter {
 public:
  std::uint64_t next(double device_time_s) {
    const double periods = std::round((device_time_s - last_s_) * nominal_rate_hz);
    if (std::exchange(is_started_, true))
      number_ += static_cast<std::uint64_t>(std::max(periods, 1.0));
    last_s_ = device_time_s;
    return number_;
  }

 private:
  bool is_started_ = false;
  double last_s_ = 0.0;
  std::uint64_t number_ = 0;
};

class FreenectCamera : public CameraSource {
 public:
  FreenectCamera(int index, double start_s)
      : name_(fmt::format("freenect:{}", index)),
        start_s_(start_s),
        context_(nullptr, &freenect_shutdown) {
    freenect_context* context = nullptr;
    require(freenect_init(&context, nullptr), "look for");
    context_.reset(context);
    freenect_select_subdevices(context, FREENECT_DEVICE_CAMERA);
    require(freenect_num_devices(context) > index ? 0 : LIBUSB_ERROR_NO_DEVICE, "find");
    require(freenect_open_device(context, &device_, index), "open");
    set_modes();
    set_callbacks();
    require(freenect_start_depth(device_), "start depth of");
    require(freenect_start_video(device_), "start colour of");
  }

  /// freenect_shutdown() stops only one stream of a device.
  ~FreenectCamera() override {
    freenect_stop_video(device_);
    freenect_stop_depth(device_);
  }

  void describe(CameraInfo& camera) const override {
    camera.width = camera.depth_width = image_width;
    camera.height = camera.depth_height = image_height;
    camera.rate_hz = nominal_rate_hz;
    camera.is_registered = true;
  }

  bool step(const RecordSink& sink) override {
    timeval timeout{0, event_timeout_us};
    sink_ = &sink;
    const int result = freenect_process_events_timeout(context_.get(), &timeout);
    sink_ = nullptr;
    if (result >= 0 || result == LIBUSB_ERROR_INTERRUPTED) return true;
    Progress::warn(fmt::format("{}: no longer connected (error {})", name_, result));
    return false;
  }

 private:
  void require(int result, const char* action) const {
    if (result >= 0) return;
    throw data_error(fmt::format("cannot {} the camera {} (error {})", action, name_, result),
                     "check with `lsusb` that a Kinect (v1) and its power supply are connected, "
                     "and that no other program uses it");
  }

  void set_modes() const {
    const auto color = freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_RGB);
    require(freenect_set_video_mode(device_, color), "get colour from");
    const auto depth =
        freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_REGISTERED);
    require(freenect_set_depth_mode(device_, depth), "get depth from");
  }

  void set_callbacks() {
    freenect_set_user(device_, this);
    freenect_set_video_callback(
        device_, [](freenect_device* sender, void* pixels, std::uint32_t ticks) {
          const std::span values(static_cast<const std::uint8_t*>(pixels), 3 * num_pixels);
          static_cast<FreenectCamera*>(freenect_get_user(sender))->pass_on_color(values, ticks);
        });
    freenect_set_depth_callback(
        device_, [](freenect_device* sender, void* pixels, std::uint32_t ticks) {
          const std::span values(static_cast<const std::uint16_t*>(pixels), num_pixels);
          static_cast<FreenectCamera*>(freenect_get_user(sender))->pass_on_depth(values, ticks);
        });
  }

  // Images also arrive while the other stream is started or stopped: then there is no sink.
  void pass_on_color(std::span<const std::uint8_t> values, std::uint32_t ticks) {
    if (sink_) (*sink_)(RecordKind::color_image, to_payload(stamp(color_counter_, ticks), values));
  }
  void pass_on_depth(std::span<const std::uint16_t> values, std::uint32_t ticks) {
    if (sink_) (*sink_)(RecordKind::depth_image, to_payload(stamp(depth_counter_, ticks), values));
  }

  FrameStamp stamp(ImageCounter& counter, std::uint32_t ticks) {
    const double device_time_s = static_cast<double>(continue_ticks(ticks)) / ticks_per_s;
    return {counter.next(device_time_s), monotonic_s() - start_s_, device_time_s};
  }

  /// The device's clock, which colour and depth share, has 32 bits and wraps after 72 s.
  std::int64_t continue_ticks(std::uint32_t ticks) {
    if (!std::exchange(has_ticks_, true)) return ticks_ = ticks;
    return ticks_ += static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(ticks_));
  }

  std::string name_;
  double start_s_;
  std::unique_ptr<freenect_context, decltype(&freenect_shutdown)> context_;
  freenect_device* device_ = nullptr;  ///< closed with the context
  const RecordSink* sink_ = nullptr;   ///< during step()
  ImageCounter color_counter_, depth_counter_;
  std::int64_t ticks_ = 0;
  bool has_ticks_ = false;
};

}  // namespace

bool has_freenect() { return true; }

std::unique_ptr<CameraSource> open_freenect(int index, double start_s) {
  return std::make_unique<FreenectCamera>(index, start_s);
}

}  // namespace touchtrace

#else

namespace touchtrace {

bool has_freenect() { return false; }

std::unique_ptr<CameraSource> open_freenect(int, double) {
  throw failure("this program was built without libfreenect",
                "install libfreenect-dev and build it again");
}

}  // namespace touchtrace

#endif
