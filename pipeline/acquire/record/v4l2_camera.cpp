#include <fcntl.h>
#include <fmt/core.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/background.h"
#include "pipeline/acquire/record/camera_source.h"
#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

constexpr unsigned num_buffers = 8;
constexpr int timeout_ms = 100;
constexpr double min_rate_share = 0.9;  // of the rate asked for

int retry_ioctl(int file, unsigned long request, void* argument) {
  int result;
  do result = ioctl(file, request, argument);
  while (result < 0 && errno == EINTR);
  return result;
}

class V4l2Camera : public CameraSource {
 public:
  V4l2Camera(std::string path, RecordKind kind, const CameraSourceOptions& options, double start_s)
      : path_(std::move(path)), kind_(kind), start_s_(start_s) {
    try {
      file_ = open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
      require(file_ >= 0, "open");
      set_format(options);
      map_buffers();
      int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      require(retry_ioctl(file_, VIDIOC_STREAMON, &type) == 0, "start");
    } catch (...) {
      close_all();
      throw;
    }
  }
  ~V4l2Camera() override { close_all(); }

  void describe(CameraInfo& camera) const override {
    const int width = static_cast<int>(format_.width), height = static_cast<int>(format_.height);
    if (kind_ == RecordKind::color_image) camera.width = width, camera.height = height;
    if (kind_ == RecordKind::depth_image) camera.depth_width = width, camera.depth_height = height;
    camera.rate_hz = rate_hz_;
  }

  bool step(const RecordSink& sink) override {
    pollfd event{file_, POLLIN, 0};
    if (poll(&event, 1, timeout_ms) <= 0) return true;
    v4l2_buffer buffer = buffer_of(0);
    if (retry_ioctl(file_, VIDIOC_DQBUF, &buffer) != 0) {
      if (errno == EAGAIN || errno == EIO) return true;  // EIO: a damaged image
      Progress::warn(fmt::format("{}: {}", path_, std::strerror(errno)));
      return false;
    }
    if (!(buffer.flags & V4L2_BUF_FLAG_ERROR)) pass_on(sink, buffer);
    return retry_ioctl(file_, VIDIOC_QBUF, &buffer) == 0;
  }

 private:
  void require(bool condition, const char* action) const {
    if (condition) return;
    throw data_error(
        fmt::format("cannot {} the camera {}: {}", action, path_, std::strerror(errno)),
        "check with `v4l2-ctl --list-formats-ext -d DEVICE` that it has YUYV or MJPG "
        "(colour) or Z16 (depth), and that no other program uses it");
  }

  static v4l2_buffer buffer_of(unsigned index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
  }

  /// Makes the driver use a pixel format with the size and rate nearest to those asked for.
  bool set_pixel_format(std::uint32_t pixels, const CameraSourceOptions& asked) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    require(retry_ioctl(file_, VIDIOC_G_FMT, &format) == 0, "use");
    if (asked.width > 0) format.fmt.pix.width = static_cast<unsigned>(asked.width);
    if (asked.height > 0) format.fmt.pix.height = static_cast<unsigned>(asked.height);
    format.fmt.pix.pixelformat = pixels;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    format.fmt.pix.bytesperline = format.fmt.pix.sizeimage = 0;
    if (retry_ioctl(file_, VIDIOC_S_FMT, &format) != 0) return false;
    if (format.fmt.pix.pixelformat != pixels) {
      errno = EINVAL;
      return false;
    }
    format_ = format.fmt.pix;
    set_rate(asked.rate_hz);
    return true;
  }

  bool is_as(const CameraSourceOptions& asked) const {
    const auto is = [](int asked_px, std::uint32_t px) {
      return asked_px <= 0 || static_cast<std::uint32_t>(asked_px) == px;
    };
    return is(asked.width, format_.width) && is(asked.height, format_.height) &&
           rate_hz_ >= min_rate_share * asked.rate_hz;
  }

  /// MJPEG where YUYV is missing, or smaller or slower than asked for, as on USB 2.
  bool set_color_format(const CameraSourceOptions& asked) {
    const bool has_yuyv = set_pixel_format(V4L2_PIX_FMT_YUYV, asked);
    if (has_yuyv && is_as(asked)) return true;
    const bool has_jpeg = set_pixel_format(V4L2_PIX_FMT_MJPEG, asked);
    return (has_jpeg && (!has_yuyv || is_as(asked))) || set_pixel_format(V4L2_PIX_FMT_YUYV, asked);
  }

  void set_format(const CameraSourceOptions& asked) {
    if (kind_ == RecordKind::depth_image)
      require(set_pixel_format(V4L2_PIX_FMT_Z16, asked), "get depth (Z16) from");
    else
      require(set_color_format(asked), "get colour (YUYV or MJPG) from");
    if (!is_as(asked))
      Progress::warn(fmt::format("{}: {} x {} px at {:.3g} Hz instead of what was asked for", path_,
                                 format_.width, format_.height, rate_hz_));
  }

  void set_rate(double rate_hz) {
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (rate_hz > 0.0) {
      parameters.parm.capture.timeperframe = {1000, static_cast<unsigned>(1000.0 * rate_hz)};
      retry_ioctl(file_, VIDIOC_S_PARM, &parameters);
    }
    if (retry_ioctl(file_, VIDIOC_G_PARM, &parameters) != 0) return;
    const auto& period = parameters.parm.capture.timeperframe;
    if (period.numerator > 0 && period.denominator > 0)
      rate_hz_ = static_cast<double>(period.denominator) / period.numerator;
  }

  void map_buffers() {
    v4l2_requestbuffers request{};
    request.count = num_buffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    require(retry_ioctl(file_, VIDIOC_REQBUFS, &request) == 0, "get buffers from");
    for (unsigned i = 0; i < request.count; ++i) {
      v4l2_buffer buffer = buffer_of(i);
      require(retry_ioctl(file_, VIDIOC_QUERYBUF, &buffer) == 0, "get buffers from");
      void* memory = mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, file_, buffer.m.offset);
      require(memory != MAP_FAILED, "map buffers of");
      buffers_.emplace_back(static_cast<std::uint8_t*>(memory), buffer.length);
      require(retry_ioctl(file_, VIDIOC_QBUF, &buffer) == 0, "queue buffers of");
    }
  }

  /// The kernel's stamps are on the monotonic clock, for most cameras at the start of the exposure.
  void pass_on(const RecordSink& sink, const v4l2_buffer& buffer) {
    const auto bytes = buffers_.at(buffer.index).first(buffer.bytesused);
    const double device_s = static_cast<double>(buffer.timestamp.tv_sec) +
                            1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
    const FrameStamp stamp{next_number(buffer.sequence), monotonic_s() - start_s_,
                           device_s - start_s_};
    if (kind_ == RecordKind::color_image) {
      const cv::Mat image = color_of(bytes);
      if (image.empty()) return;
      const auto values = rgb_values(image);
      sink(kind_, to_payload(stamp, std::span(values)));
    } else if (bytes.size() >= format_.bytesperline * format_.height) {
      const auto values = depth_of(bytes);
      sink(kind_, to_payload(stamp, std::span(values)));
    }
  }

  /// The kernel's counter has 32 bits.
  std::uint64_t next_number(std::uint32_t sequence) {
    return number_ += static_cast<std::uint32_t>(sequence - static_cast<std::uint32_t>(number_));
  }

  /// Blue first; empty if the image is damaged.
  cv::Mat color_of(std::span<std::uint8_t> bytes) const {
    const int width = static_cast<int>(format_.width), height = static_cast<int>(format_.height);
    cv::Mat image;
    if (format_.pixelformat == V4L2_PIX_FMT_MJPEG)
      image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()),
                           cv::IMREAD_COLOR);
    else if (bytes.size() >= format_.bytesperline * format_.height)
      cv::cvtColor(cv::Mat(height, width, CV_8UC2, bytes.data(), format_.bytesperline), image,
                   cv::COLOR_YUV2BGR_YUYV);
    return image.cols == width && image.rows == height ? image : cv::Mat();
  }

  std::vector<std::uint16_t> depth_of(std::span<const std::uint8_t> bytes) const {
    std::vector<std::uint16_t> values(format_.width * format_.height);
    for (std::size_t row = 0; row < format_.height; ++row)
      std::memcpy(&values[row * format_.width], &bytes[row * format_.bytesperline],
                  2 * format_.width);
    return values;
  }

  void close_all() {
    for (const auto& buffer : buffers_) munmap(buffer.data(), buffer.size());
    if (file_ >= 0) close(file_);
  }

  std::string path_;
  RecordKind kind_;
  double start_s_, rate_hz_ = 30.0;
  int file_ = -1;
  v4l2_pix_format format_{};
  std::vector<std::span<std::uint8_t>> buffers_;
  std::uint64_t number_ = 0;
};

}  // namespace

std::unique_ptr<CameraSource> open_v4l2(const std::string& path, RecordKind kind,
                                        const CameraSourceOptions& options, double start_s) {
  return std::make_unique<V4l2Camera>(path, kind, options, start_s);
}

}  // namespace touchtrace
