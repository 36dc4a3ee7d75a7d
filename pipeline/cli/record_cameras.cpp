#include <fmt/core.h>

#include <charconv>
#include <filesystem>

#include "engine/base/error.h"
#include "pipeline/cli/record_devices.h"

namespace touchtrace::cli {
namespace {

constexpr const char* freenect_name = "freenect";
constexpr const char* openni2_name = "openni2";

/// Device of a library: "1" of "freenect:1", "" of "freenect". nullopt: not of this library.
std::optional<std::string> device_of(const std::string& camera, const std::string& library) {
  if (camera == library) return "";
  if (camera.starts_with(library + ":")) return camera.substr(library.size() + 1);
  return std::nullopt;
}

std::optional<std::string> freenect_device(const std::string& camera) {
  return device_of(camera, freenect_name);
}

std::optional<std::string> openni2_device(const std::string& camera) {
  return camera.ends_with(".oni") ? camera : device_of(camera, openni2_name);
}

int parse_index(const std::string& text, const std::string& camera) {
  int index = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, index);
  if (text.empty() || (error == std::errc() && rest == end && index >= 0)) return index;
  throw usage_error(fmt::format("cannot read the camera '{}'", camera),
                    "write freenect:INDEX, as in freenect:1 for the second Kinect");
}

std::unique_ptr<CameraSource> open_camera(const std::string& camera,
                                          const CameraSourceOptions& images, double start_s) {
  if (const auto index = freenect_device(camera))
    return open_freenect(parse_index(*index, camera), start_s);
  if (const auto uri = openni2_device(camera)) return open_openni2(*uri, images, start_s);
  if (std::filesystem::is_character_file(camera))
    return open_v4l2(camera, RecordKind::color_image, images, start_s);
  return open_image_replay(camera, images, start_s);
}

}  // namespace

void describe_cameras(OptionSet& set, DeviceOptions& o) {
  set.group("Camera");
  set.text("camera", o.camera,
           "V4L2 device with colour, such as /dev/video0; freenect[:INDEX] (Kinect v1) or "
           "openni2[:URI], with colour and depth; .oni file, or images that `import` reads")
      .value("SOURCE");
  set.text("depth-camera", o.depth_camera, "V4L2 device with depth (Z16, in mm)").value("DEVICE");
  set.integer("width", o.images.width,
              "of V4L2 and OpenNI2 images [px]; 0: as the driver is set, OpenNI2: 640", 0, 16384);
  set.integer("height", o.images.height,
              "of V4L2 and OpenNI2 images [px]; 0: as the driver is set, OpenNI2: 480", 0, 16384);
  set.number("camera-rate", o.images.rate_hz,
             "of a V4L2 or OpenNI2 device, or of images without stamps [Hz]; 0: as the driver is "
             "set, OpenNI2: 30",
             0.0, 1e3);
}

std::vector<std::unique_ptr<CameraSource>> open_cameras(const DeviceOptions& options,
                                                        double start_s) {
  if (!options.depth_camera.empty() &&
      (freenect_device(options.camera) || openni2_device(options.camera)))
    throw usage_error(
        fmt::format("--depth-camera cannot be combined with --camera {}", options.camera),
        "leave out --depth-camera: this camera has depth");
  std::vector<std::unique_ptr<CameraSource>> cameras;
  CameraSourceOptions images = options.images;
  images.replay_speed = options.speed;
  if (!options.camera.empty()) cameras.push_back(open_camera(options.camera, images, start_s));
  if (!options.depth_camera.empty())
    cameras.push_back(open_v4l2(options.depth_camera, RecordKind::depth_image, images, start_s));
  return cameras;
}

}  // namespace touchtrace::cli
