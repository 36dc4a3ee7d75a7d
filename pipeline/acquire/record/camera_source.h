#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/acquire/import/source_camera.h"
#include "pipeline/acquire/record/source.h"

namespace touchtrace {

/// Camera, or one stream of it.
class CameraSource : public RecordSource {
 public:
  /// Sets the members of its streams.
  virtual void describe(CameraInfo& camera) const = 0;
};

struct CameraSourceOptions {
  double rate_hz = 0.0;       ///< of images without stamps (folder); asked for (device); 0: unknown
  int width = 0, height = 0;  ///< asked for (V4L2, OpenNI2); 0: the default
  CameraOptions folder;       ///< of a folder
  double replay_speed = 1.0;  ///< of a folder or file; 0: no pauses
};

/// Image folder, TUM RGB-D folder, bag or .npz, replayed at its own times. `start_s`: time of
/// monotonic_s() that is 0 in the recording. Throws data_error.
std::unique_ptr<CameraSource> open_image_replay(const std::filesystem::path& path,
                                                const CameraSourceOptions& options, double start_s);

/// V4L2 device such as /dev/video0. `kind`: color_image (YUYV or MJPEG) or depth_image (Z16, in
/// millimetres). Throws data_error.
std::unique_ptr<CameraSource> open_v4l2(const std::string& path, RecordKind kind,
                                        const CameraSourceOptions& options, double start_s);

/// Kinect (v1) number `index` through libfreenect: colour, and depth that the library registers to
/// it, in millimetres. Throws data_error, or failure without libfreenect.
std::unique_ptr<CameraSource> open_freenect(int index, double start_s);
/// Whether the program was built with libfreenect.
bool has_freenect();

/// Colour and depth of an OpenNI2 device or .oni file. Depth is in millimetres, and registered to
/// colour if the device can do it. `uri`: the device's name, or path of the file; empty: any
/// device. Throws data_error, or failure without OpenNI2.
std::unique_ptr<CameraSource> open_openni2(const std::string& uri,
                                           const CameraSourceOptions& options, double start_s);
/// Whether the program was built with OpenNI2.
bool has_openni2();

}  // namespace touchtrace
