#include "pipeline/acquire/import/source_camera.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/intrinsics.h"
#include "pipeline/acquire/import/registration_check.h"
#include "pipeline/acquire/import/resized_depth.h"
#include "pipeline/recording/intrinsics_check.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

struct Cameras {
  std::optional<Camera> color, depth;
  std::optional<Eigen::Isometry3d> depth_from_color = std::nullopt;
};

/// Format of the first image that can be decoded. Throws data_error if there is none.
ImageFormat first_format(const SourceStream& stream, const char* kind) {
  std::string fault = "there are none";
  for (std::size_t i = 0; i < stream.images.size(); ++i) try {
      const cv::Mat image = stream.read(i);
      return {image.size(), image.type()};
    } catch (const std::exception& error) {
      fault = fmt::format("{}: {}", stream.images[i].name, error.what());
    }
  throw data_error(fmt::format("no {} image can be read; {}", kind, fault),
                   "depth is 16-bit PNG or arrays, colour is 8-bit PNG or JPEG");
}

fs::path folder_of(const fs::path& source) {
  return fs::is_directory(source) ? source : fs::absolute(source).parent_path();
}

/// Counts per metre of --depth-scale, else of the file with the intrinsics; 0: not stated.
double stated_depth_scale(const fs::path& path, const CameraOptions& options, int type) {
  if (options.depth_scale > 0.0 || type != CV_16UC1) return options.depth_scale;
  const fs::path file = options.camera_info.empty()
                            ? find_intrinsics(folder_of(path)).color.value_or(fs::path())
                            : fs::path(options.camera_info);
  const auto counts = stated_counts_per_m(file);
  if (counts)
    Progress::report(fmt::format("depth has {:g} counts per metre, as {} states (--depth-scale N)",
                                 *counts, file.string()));
  return counts.value_or(0.0);
}

/// Cameras of --camera-info, else of the source, else of files in its folder.
Cameras find_cameras(const fs::path& path, const ImportSource& source, const std::string& file,
                     const cv::Size& color, const cv::Size& depth) {
  Cameras cameras{source.color.camera, source.depth.camera};
  const auto add = [&](const fs::path& intrinsics) {
    const RgbdCalibration calibration = read_intrinsics(intrinsics, color.width, color.height);
    cameras.color = calibration.color;
    if (!calibration.depth) return;
    cameras.depth = calibration.depth;
    cameras.depth_from_color = calibration.depth_from_color;
  };
  const IntrinsicsFiles files = find_intrinsics(folder_of(path));
  if (!file.empty()) add(file);
  if (!cameras.color && files.color) add(*files.color);
  if (!cameras.depth && files.depth)
    cameras.depth = read_intrinsics(*files.depth, depth.width, depth.height).color;
  return cameras;
}

/// Delay of depth images of 0.75 intervals and more; nullopt: less, or unknown.
std::optional<DepthDelay> notable_delay(const ImportSource& source) {
  const auto delay = measure_depth_delay(source.color, source.depth);
  return delay && std::abs(delay->images) >= 0.75 ? delay : std::nullopt;
}

void warn_of_depth_delay(const ImportSource& source, double offset_s) {
  const auto delay = notable_delay(source);
  if (!delay) return;
  Progress::warn(
      fmt::format("depth images show what moves {:.3f} s {} than colour images of the same time; "
                  "`touchtrace import --depth-offset {:.3f}` corrects it",
                  std::abs(delay->seconds), delay->seconds > 0.0 ? "later" : "earlier",
                  offset_s - delay->seconds));
}

/// Whether what moves in both streams contradicts that depth is on the colour camera's pixels.
/// Depth that is late looks displaced, too.
bool contradicts_registration(const ImportSource& source, int width) {
  const auto shift = measure_motion_shift(source.color, source.depth);
  if (!shift || shift->is_consistent_with_registration(width) || notable_delay(source))
    return false;
  Progress::warn(
      fmt::format("what moves in depth images is displaced by ({:+.0f}, {:+.0f}) pixels from what "
                  "moves in colour images, as if depth were not registered",
                  shift->depth_from_color_px.x, shift->depth_from_color_px.y));
  return true;
}

/// Whether depth images are on the colour camera's pixels, as the user or the source states it;
/// else whether they have the same size, no intrinsics of their own, and show the same motion.
bool decide_registered(const ImportSource& source, const CameraOptions& options, bool is_same_size,
                       bool has_depth_camera, int width) {
  if (options.registered && is_same_size) contradicts_registration(source, width);  // warns
  if (options.registered || options.no_registered) return options.registered;
  const bool may_be = is_same_size && source.is_registered.value_or(!has_depth_camera);
  const bool is_contradicted = may_be && contradicts_registration(source, width);
  if (source.is_registered && is_same_size) return *source.is_registered;
  const bool is_registered = may_be && !is_contradicted;
  Progress::report(
      is_registered ? "depth is taken as registered to colour: same size, no intrinsics of its own "
                      "(--no-registered: it is not)"
                    : "depth is taken as not registered to colour (--registered: it is)");
  return is_registered;
}

void set_cameras(CameraInfo& info, const Cameras& cameras) {
  info.color_camera = cameras.color;
  info.depth_camera = info.is_registered ? cameras.color : cameras.depth;
  if (!info.is_registered) info.depth_from_color = cameras.depth_from_color;
  if (!info.color_camera)
    Progress::warn(
        "no intrinsics found (--camera-info FILE); label will need "
        "--calibration");
  else if (!info.is_registered && !info.depth_from_color)
    Progress::warn(
        "the pose of the depth camera is unknown (--camera-info with a "
        "camchain or a folder of calibrate); label will need --calibration");
  for (const auto& fault : implausible_intrinsics(info)) Progress::warn(fault);
}

}  // namespace

SourceCamera describe_camera(const fs::path& path, const ImportSource& source,
                             const CameraOptions& options) {
  SourceCamera camera{.info = {}, .color = first_format(source.color, "colour"), .depth = {}};
  CameraInfo& info = camera.info;
  info.width = camera.color.size.width, info.height = camera.color.size.height;
  if (!source.depth.images.empty()) {
    camera.depth = first_format(source.depth, "depth");
    const double stated = stated_depth_scale(path, options, camera.depth.type);
    camera.depth_scale =
        plausible_scale(depth_scale(source, camera.depth.type, stated), source.depth, stated > 0.0);
    info.depth_unit_m = camera.depth_scale.unit_m;
    info.depth_width = camera.depth.size.width, info.depth_height = camera.depth.size.height;
  }
  const cv::Size color = camera.color.size, depth = camera.depth.size;
  Cameras cameras = find_cameras(path, source, options.camera_info, color, depth);
  if (!depth.empty() && depth != color && options.registered) {
    cameras.depth = resized_depth_camera(cameras.color, color, depth);
    cameras.depth_from_color = Eigen::Isometry3d::Identity();
  } else if (!depth.empty())
    info.is_registered =
        decide_registered(source, options, depth == color, cameras.depth.has_value(), info.width);
  if (info.is_registered) warn_of_depth_delay(source, options.depth_offset_s);
  set_cameras(info, cameras);
  if (!options.gravity_m_per_s2.empty())
    info.gravity_m_per_s2 = Eigen::Vector3d(options.gravity_m_per_s2.data());
  return camera;
}

}  // namespace touchtrace
