// Records all images of the first OpenNI2 device in a file, mirrored. usage: record_oni FILE
#include <OpenNI.h>

#include <future>

namespace {

struct Unplugged : openni::OpenNI::DeviceDisconnectedListener {
  void onDeviceDisconnected(const openni::DeviceInfo*) override { promise.set_value(); }
  std::promise<void> promise;
};

bool record(const char* file) {
  Unplugged unplugged;
  openni::OpenNI::addDeviceDisconnectedListener(&unplugged);
  openni::Device device;
  openni::VideoStream color, depth;
  openni::Recorder recorder;
  const bool is_ready =
      device.open(openni::ANY_DEVICE) == openni::STATUS_OK &&
      color.create(device, openni::SENSOR_COLOR) == openni::STATUS_OK &&
      depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK &&
      recorder.create(file) == openni::STATUS_OK && recorder.attach(color) == openni::STATUS_OK &&
      recorder.attach(depth) == openni::STATUS_OK && recorder.start() == openni::STATUS_OK &&
      color.start() == openni::STATUS_OK && depth.start() == openni::STATUS_OK;
  if (is_ready) unplugged.promise.get_future().wait();
  recorder.stop();
  recorder.destroy();
  openni::OpenNI::removeDeviceDisconnectedListener(&unplugged);
  return is_ready;
}

}  // namespace

int main(int, char** arguments) {
  openni::OpenNI::initialize();
  const bool is_recorded = record(arguments[1]);
  openni::OpenNI::shutdown();
  return is_recorded ? 0 : 1;
}
