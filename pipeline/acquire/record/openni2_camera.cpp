#include "engine/base/error.h"
#include "pipeline/acquire/record/camera_source.h"

#ifdef TOUCHTRACE_OPENNI2
#include <OpenNI.h>
#include <fmt/core.h>

#include <atomic>
#include <opencv2/core.hpp>
#include <tuple>

#include "engine/base/progress.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

using openni::OpenNI;

constexpr int default_width = 640, default_height = 480;
constexpr double default_rate_hz = 30.0;
// A file delivers a frame per request. A request that is not awaited may make it skip a frame.
constexpr int device_timeout_ms = 100, file_timeout_ms = 2000;
constexpr float frame_per_request = -1.0f;  // speed of OpenNI2's player

/// Message of OpenNI2 without blanks around it.
std::string reason() {
  const std::string_view text = OpenNI::getExtendedError();
  const auto first = text.find_first_not_of(" \t\n"), last = text.find_last_not_of(" \t\n");
  return first == text.npos ? "unknown reason" : std::string(text.substr(first, last - first + 1));
}

/// OpenNI2 while it is in use.
struct OpenniLibrary {
  OpenniLibrary() {
    if (OpenNI::initialize() == openni::STATUS_OK) return;
    throw data_error(fmt::format("cannot start OpenNI2: {}", reason()),
                     "check that libopenni2-0 is installed, with its drivers");
  }
  ~OpenniLibrary() { OpenNI::shutdown(); }
  OpenniLibrary(const OpenniLibrary&) = delete;
  OpenniLibrary& operator=(const OpenniLibrary&) = delete;
};

/// Notices that a device is unplugged, or that a file has ended.
class EndListener : OpenNI::DeviceDisconnectedListener, OpenNI::DeviceStateChangedListener {
 public:
  explicit EndListener(std::string uri) : uri_(std::move(uri)) {
    OpenNI::addDeviceDisconnectedListener(this);
    OpenNI::addDeviceStateChangedListener(this);
  }
  ~EndListener() {
    OpenNI::removeDeviceDisconnectedListener(this);
    OpenNI::removeDeviceStateChangedListener(this);
  }
  bool is_unplugged() const { return is_unplugged_; }
  bool is_at_end() const { return is_at_end_; }

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* device) override {
    if (uri_ == device->getUri()) is_unplugged_ = true;
  }
  void onDeviceStateChanged(const openni::DeviceInfo* device, openni::DeviceState state) override {
    if (uri_ == device->getUri() && state == openni::DEVICE_STATE_EOF) is_at_end_ = true;
  }

  std::string uri_;
  std::atomic<bool> is_unplugged_ = false, is_at_end_ = false;
};

/// Mode of the pixel format whose size and rate are nearest to the wanted ones. The format differs
/// if the sensor does not have it.
openni::VideoMode choose_mode(const openni::Array<openni::VideoMode>& modes,
                              openni::PixelFormat format, const CameraSourceOptions& options) {
  const int width = options.width > 0 ? options.width : default_width;
  const int height = options.height > 0 ? options.height : default_height;
  const double rate_hz = options.rate_hz > 0.0 ? options.rate_hz : default_rate_hz;
  const auto distance = [&](const openni::VideoMode& mode) {
    return std::tuple(
        mode.getPixelFormat() != format,
        std::abs(mode.getResolutionX() - width) + std::abs(mode.getResolutionY() - height),
        std::abs(mode.getFps() - rate_hz));
  };
  openni::VideoMode best;
  for (int i = 0; i < modes.getSize(); ++i)
    if (i == 0 || distance(modes[i]) < distance(best)) best = modes[i];
  return best;
}

class OpenniCamera : public CameraSource {
 public:
  OpenniCamera(const std::string& uri, const CameraSourceOptions& options, double start_s)
      : name_(uri.empty() ? "openni2" : uri), speed_(options.replay_speed), start_s_(start_s) {
    require(device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()), "open");
    end_.emplace(device_.getDeviceInfo().getUri());
    is_file_ = device_.isFile();
    if (is_file_) prepare_file();
    constexpr auto registration = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (device_.isImageRegistrationModeSupported(registration))
      device_.setImageRegistrationMode(registration);
    open(color_, openni::SENSOR_COLOR, openni::PIXEL_FORMAT_RGB888, options);
    open(depth_, openni::SENSOR_DEPTH, openni::PIXEL_FORMAT_DEPTH_1_MM, options);
    require(color_.video.start(), "start colour of");
    require(depth_.video.start(), "start depth of");
    replay_start_s_ = monotonic_s();
  }

  void describe(CameraInfo& camera) const override {
    camera.width = color_.size.width, camera.height = color_.size.height;
    camera.depth_width = depth_.size.width, camera.depth_height = depth_.size.height;
    camera.rate_hz = std::max(1, depth_.video.getVideoMode().getFps());
    camera.is_registered =
        color_.size == depth_.size &&
        device_.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  }

  bool step(const RecordSink& sink) override {
    if (!frame_.isValid() && !read_frame()) return may_continue();
    if (is_file_ && !wait_until_due()) return true;
    pass_on(sink);
    frame_.release();
    return true;
  }

 private:
  struct Stream {
    openni::VideoStream video;
    cv::Size size;
    bool is_mirrored = false;
  };

  void require(openni::Status status, const char* action) const {
    if (status == openni::STATUS_OK) return;
    throw data_error(
        fmt::format("cannot {} the camera {}: {}", action, name_, reason()),
        "check with `NiViewer2` (openni2-utils) that it has colour and depth, and that no other "
        "program uses it");
  }

  /// Lets the player deliver each frame, however long that takes.
  void prepare_file() {
    openni::PlaybackControl& player = *device_.getPlaybackControl();
    require(player.setRepeatEnabled(false), "replay");
    require(player.setSpeed(frame_per_request), "replay");
  }

  /// A file has only the mode that was recorded, and may be mirrored.
  void open(Stream& stream, openni::SensorType sensor, openni::PixelFormat format,
            const CameraSourceOptions& options) const {
    require(stream.video.create(device_, sensor), "get colour and depth from");
    stream.video.setVideoMode(
        choose_mode(stream.video.getSensorInfo().getSupportedVideoModes(), format, options));
    stream.video.setMirroringEnabled(false);
    const openni::VideoMode mode = stream.video.getVideoMode();
    require(mode.getPixelFormat() == format ? openni::STATUS_OK : openni::STATUS_NOT_SUPPORTED,
            "get RGB888 and depth in mm from");
    stream.size = {mode.getResolutionX(), mode.getResolutionY()};
    stream.is_mirrored = stream.video.getMirroringEnabled();
  }

  bool read_frame() {
    openni::VideoStream* streams[]{&color_.video, &depth_.video};
    const int timeout_ms = is_file_ ? file_timeout_ms : device_timeout_ms;
    int ready = 0;
    if (OpenNI::waitForAnyStream(streams, 2, &ready, end_->is_at_end() ? 0 : timeout_ms) !=
            openni::STATUS_OK ||
        streams[ready]->readFrame(&frame_) != openni::STATUS_OK)
      return false;
    device_time_s_ = 1e-6 * static_cast<double>(frame_.getTimestamp());
    if (!first_s_) first_s_ = device_time_s_;
    return frame_.isValid();
  }

  /// Whether frames may follow, although there was none.
  bool may_continue() const {
    if (end_->is_at_end()) return false;
    if (!is_file_ && !end_->is_unplugged()) return true;
    Progress::warn(
        fmt::format("{}: {}", name_, is_file_ ? "the file is damaged" : "no longer connected"));
    return false;
  }

  /// Waits until a file's frame is due, but not for long. Returns whether it is due.
  bool wait_until_due() const {
    return speed_ == 0.0 || wait_for_time(replay_start_s_ + (device_time_s_ - *first_s_) / speed_);
  }

  void pass_on(const RecordSink& sink) const {
    const bool is_color = frame_.getSensorType() == openni::SENSOR_COLOR;
    const Stream& stream = is_color ? color_ : depth_;
    const cv::Size size(frame_.getWidth(), frame_.getHeight());
    const int stride = frame_.getStrideInBytes();
    if (size != stream.size || frame_.getDataSize() < stride * size.height) return;
    cv::Mat image(size, is_color ? CV_8UC3 : CV_16UC1, const_cast<void*>(frame_.getData()),
                  static_cast<std::size_t>(stride));
    image = image.clone();
    if (stream.is_mirrored) cv::flip(image, image, 1);
    if (is_color)
      sink(RecordKind::color_image,
           to_payload(stamp(), std::span<const std::uint8_t>(image.data, 3 * image.total())));
    else
      sink(RecordKind::depth_image,
           to_payload(stamp(),
                      std::span<const std::uint16_t>(image.ptr<std::uint16_t>(), image.total())));
  }

  FrameStamp stamp() const {
    const double host_time_s =
        is_file_ ? replay_start_s_ + device_time_s_ - *first_s_ : monotonic_s();
    return {static_cast<std::uint64_t>(frame_.getFrameIndex()), host_time_s - start_s_,
            device_time_s_};
  }

  std::string name_;
  double speed_, start_s_, replay_start_s_ = 0.0;
  OpenniLibrary library_;
  openni::Device device_;
  std::optional<EndListener> end_;
  bool is_file_ = false;
  Stream color_, depth_;
  openni::VideoFrameRef frame_;  ///< that was not passed on yet
  double device_time_s_ = 0.0;   ///< of the frame
  std::optional<double> first_s_;
};

}  // namespace

bool has_openni2() { return true; }

std::unique_ptr<CameraSource> open_openni2(const std::string& uri,
                                           const CameraSourceOptions& options, double start_s) {
  return std::make_unique<OpenniCamera>(uri, options, start_s);
}

}  // namespace touchtrace

#else

namespace touchtrace {

bool has_openni2() { return false; }

std::unique_ptr<CameraSource> open_openni2(const std::string&, const CameraSourceOptions&, double) {
  throw failure("this program was built without OpenNI2",
                "install libopenni2-dev and build it again");
}

}  // namespace touchtrace

#endif
