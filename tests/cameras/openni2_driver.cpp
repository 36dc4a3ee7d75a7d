// Driver of a simulated camera for OpenNI2: "tests/cameras/simulated_camera.h" has its images. It
// is unplugged when it has sent all of them.
#include <atomic>
#include <cstring>
#include <functional>
#include <thread>

#define XN_NEW(Type, ...) new Type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include "tests/cameras/simulated_camera.h"

namespace touchtrace::testing {
namespace {

constexpr OniVideoMode mode_of(OniPixelFormat format, int width, int height) {
  return {format, width, height, 30};
}

OniVideoMode color_modes[]{
    mode_of(ONI_PIXEL_FORMAT_YUV422, simulated_width, simulated_height),
    mode_of(ONI_PIXEL_FORMAT_RGB888, 2 * simulated_width, 2 * simulated_height),
    mode_of(ONI_PIXEL_FORMAT_RGB888, simulated_width, simulated_height)};
OniVideoMode depth_modes[]{
    mode_of(ONI_PIXEL_FORMAT_DEPTH_100_UM, simulated_width, simulated_height),
    mode_of(ONI_PIXEL_FORMAT_DEPTH_1_MM, 2 * simulated_width, 2 * simulated_height),
    mode_of(ONI_PIXEL_FORMAT_DEPTH_1_MM, simulated_width, simulated_height)};
OniSensorInfo sensors[]{{ONI_SENSOR_COLOR, 3, color_modes}, {ONI_SENSOR_DEPTH, 3, depth_modes}};

OniDeviceInfo device_info{"simulated", "touchtrace", "simulated camera", 0, 0};

template <class Value>
OniStatus give(const Value& value, void* data, int* size) {
  if (*size != sizeof value) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

template <class Value>
OniStatus take(const void* data, int size, Value& value) {
  if (size != sizeof value) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(&value, data, sizeof value);
  return ONI_STATUS_OK;
}

class SimulatedDevice;

/// Like those of PrimeSense's devices, streams are mirrored unless they are told not to be.
class SimulatedStream : public oni::driver::StreamBase {
 public:
  SimulatedStream(SimulatedDevice& device, bool is_color)
      : device_(device), is_color_(is_color), mode_((is_color ? color_modes : depth_modes)[2]) {}
  ~SimulatedStream() override { stop(); }

  OniStatus start() override {
    stop();
    is_stopped_ = false;
    thread_ = std::thread([this] { send_all(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    is_stopped_ = true;
    if (thread_.joinable()) thread_.join();
  }

  OniStatus getProperty(int property, void* data, int* size) override {
    switch (property) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return give(mode_, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return give(is_mirrored_, data, size);
      case ONI_STREAM_PROPERTY_CROPPING:
        return give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return give(10'000, data, size);
      default:
        return ONI_STATUS_NOT_IMPLEMENTED;
    }
  }
  OniStatus setProperty(int property, const void* data, int size) override {
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) return take(data, size, mode_);
    if (property == ONI_STREAM_PROPERTY_MIRRORING) return take(data, size, is_mirrored_);
    return ONI_STATUS_NOT_IMPLEMENTED;
  }

 private:
  void send_all();
  void send(int number);
  void fill(OniFrame& frame, int number) const;

  SimulatedDevice& device_;
  bool is_color_;
  OniVideoMode mode_;
  OniBool is_mirrored_ = TRUE;
  std::atomic<bool> is_stopped_ = false;
  std::thread thread_;
};

class SimulatedDevice : public oni::driver::DeviceBase {
 public:
  explicit SimulatedDevice(std::function<void()> unplug) : unplug_(std::move(unplug)) {}

  OniStatus getSensorInfoList(OniSensorInfo** list, int* size) override {
    *list = sensors, *size = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    return new SimulatedStream(*this, sensor == ONI_SENSOR_COLOR);
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override { return TRUE; }
  OniBool isPropertySupported(int property) override {
    return property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    if (property != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_IMPLEMENTED;
    return give(registration_, data, size);
  }
  OniStatus setProperty(int property, const void* data, int size) override {
    if (property != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_IMPLEMENTED;
    return take(data, size, registration_);
  }

  bool is_registered() const { return registration_ == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR; }
  void finish_stream() {
    if (++finished_ == 2) unplug_();
  }

 private:
  std::function<void()> unplug_;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::atomic<int> finished_ = 0;
};

void SimulatedStream::send_all() {
  for (int number = 1; number <= simulated_frames && !is_stopped_; ++number) {
    send(number);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  device_.finish_stream();
}

void SimulatedStream::send(int number) {
  OniFrame* frame = getServices().acquireFrame();
  if (!frame) return;
  frame->frameIndex = number;
  frame->timestamp = simulated_stamp_us(number, is_color_);
  frame->sensorType = is_color_ ? ONI_SENSOR_COLOR : ONI_SENSOR_DEPTH;
  frame->videoMode = mode_;
  frame->width = mode_.resolutionX, frame->height = mode_.resolutionY;
  frame->stride = frame->width * (is_color_ ? 3 : 2);
  frame->dataSize = frame->stride * frame->height;
  frame->croppingEnabled = FALSE, frame->cropOriginX = frame->cropOriginY = 0;
  fill(*frame, number);
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

void SimulatedStream::fill(OniFrame& frame, int number) const {
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const int shown_x = is_mirrored_ ? frame.width - 1 - x : x;
      const std::size_t pixel = static_cast<std::size_t>(y * frame.width + x);
      if (is_color_)
        for (std::size_t c = 0; c < 3; ++c)
          static_cast<std::uint8_t*>(frame.data)[3 * pixel + c] =
              simulated_color(shown_x, y, static_cast<int>(c), number);
      else
        static_cast<std::uint16_t*>(frame.data)[pixel] =
            simulated_depth(shown_x, y, number, device_.is_registered());
    }
}

class SimulatedDriver : public oni::driver::DriverBase {
 public:
  using DriverBase::DriverBase;

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    deviceConnected(&device_info);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char*, const char*) override {
    return new SimulatedDevice([this] { deviceDisconnected(&device_info); });
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}
};

}  // namespace
}  // namespace touchtrace::testing

ONI_EXPORT_DRIVER(touchtrace::testing::SimulatedDriver)
