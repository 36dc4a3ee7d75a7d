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
  double rate_hz = 0.0;       ///< of images without stamps (folder); asked for (V4L2); 0: unknown
  int width = 0, height = 0;  ///< asked for (V4L2); 0: as the driver is set
  CameraOptions folder;       ///< of a folder
  double replay_speed = 1.0;  ///< of a folder; 0: no pauses
};

/// Image folder, TUM RGB-D folder, bag or .npz, replayed at its own times. `start_s`: time of
/// monotonic_s() that is 0 in the recording. Throws data_error.
std::unique_ptr<CameraSource> open_image_replay(const std::filesystem::path& path,
                                                const CameraSourceOptions& options, double start_s);

/// V4L2 device such as /dev/video0. `kind`: color_image (YUYV or MJPEG) or depth_image (Z16, in
/// millimetres). Throws data_error.
std::unique_ptr<CameraSource> open_v4l2(const std::string& path, RecordKind kind,
                                        const CameraSourceOptions& options, double start_s);

}  // namespace touchtrace
