#include "pipeline/cli/record_devices.h"

#include <fmt/core.h>

#include <filesystem>

#include "engine/base/error.h"

namespace touchtrace::cli {
namespace {

GloveInfo glove_info(const DeviceOptions& options, const GloveProtocol& protocol) {
  GloveInfo info = protocol.usual_glove;
  info.name = protocol.name;
  if (options.rows > 0) info.rows = options.rows;
  if (options.cols > 0) info.cols = options.cols;
  if (options.bits > 0) info.bits = options.bits;
  if (options.rate_hz > 0.0) info.rate_hz = options.rate_hz;
  if (options.polarity != 0) info.polarity = options.polarity;
  require_supported(protocol, info);
  return info;
}

std::vector<std::unique_ptr<CameraSource>> open_cameras(const DeviceOptions& options,
                                                        double start_s) {
  std::vector<std::unique_ptr<CameraSource>> cameras;
  CameraSourceOptions images = options.images;
  images.replay_speed = options.speed;
  if (!options.camera.empty())
    cameras.push_back(std::filesystem::is_character_file(options.camera)
                          ? open_v4l2(options.camera, RecordKind::color_image, images, start_s)
                          : open_image_replay(options.camera, images, start_s));
  if (!options.depth_camera.empty())
    cameras.push_back(open_v4l2(options.depth_camera, RecordKind::depth_image, images, start_s));
  return cameras;
}

}  // namespace

void describe_glove(OptionSet& set, DeviceOptions& o) {
  set.number("speed", o.speed, "of files, relative to the device; 0: no pauses", 0.0, 1e6);
  set.group("Glove");
  set.text("glove", o.glove, "serial port, usb:VENDOR:PRODUCT, or a file with the glove's bytes")
      .value("PORT");
  set.choice("protocol", o.protocol, "serial protocol of the device", glove_protocol_names());
  set.integer("baud", o.baud, "bits per second; 0: the protocol's", 0, 12'000'000);
  set.integer("rows", o.rows, "rows of taxels; 0: the protocol's", 0, 255);
  set.integer("cols", o.cols, "columns of taxels; 0: the protocol's", 0, 255);
  set.integer("bits", o.bits, "of the converter; 0: the protocol's", 0, 16);
  set.integer("polarity", o.polarity,
              "1: counts increase with pressure, -1: they decrease; 0: the protocol's", -1, 1);
  set.number("rate-hz", o.rate_hz, "nominal frames per second; 0: the protocol's", 0.0, 1e4);
}

void describe(OptionSet& set, DeviceOptions& o) {
  describe_glove(set, o);
  set.group("Camera");
  set.text("camera", o.camera,
           "V4L2 device with colour, such as /dev/video0, or images that `import` reads")
      .value("SOURCE");
  set.text("depth-camera", o.depth_camera, "V4L2 device with depth (Z16, in mm)").value("DEVICE");
  set.integer("width", o.images.width, "of V4L2 images [px]; 0: as the driver is set", 0, 16384);
  set.integer("height", o.images.height, "of V4L2 images [px]; 0: as the driver is set", 0, 16384);
  set.number("camera-rate", o.images.rate_hz,
             "of a V4L2 device, or of images without stamps [Hz]; 0: as the driver is set", 0.0,
             1e3);
}

std::vector<RecordSource*> Devices::sources() const {
  std::vector<RecordSource*> all;
  if (glove) all.push_back(glove.get());
  for (const auto& camera : cameras) all.push_back(camera.get());
  return all;
}

Devices open_devices(const DeviceOptions& options, SessionInfo& session) {
  const double start_s = monotonic_s();
  Devices devices{nullptr, open_cameras(options, start_s)};
  if (!devices.cameras.empty()) session.camera.emplace();
  for (const auto& camera : devices.cameras) camera->describe(*session.camera);
  if (!options.glove.empty()) {
    const GloveProtocol& protocol = find_glove_protocol(options.protocol);
    session.glove = glove_info(options, protocol);
    devices.glove = std::make_unique<GloveSource>(
        protocol, *session.glove, GloveSource::Options{options.glove, options.baud, options.speed},
        start_s);
  }
  if (devices.sources().empty())
    throw usage_error("nothing to record",
                      "give --glove PORT (`touchtrace doctor` lists ports) or --camera SOURCE");
  return devices;
}

}  // namespace touchtrace::cli
