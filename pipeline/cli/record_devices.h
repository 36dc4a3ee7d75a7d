#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/options.h"
#include "pipeline/acquire/record/camera_source.h"
#include "pipeline/acquire/record/glove_source.h"
#include "pipeline/acquire/record/session.h"

namespace touchtrace::cli {

/// Options of `record` that name and describe devices.
struct DeviceOptions {
  std::string glove, protocol = "actionsense", camera, depth_camera;
  int baud = 0, rows = 0, cols = 0, bits = 0, polarity = 0;
  double rate_hz = 0.0, speed = 1.0;
  CameraSourceOptions images;
};

/// Options of the glove, and `--speed`.
void describe_glove(OptionSet& set, DeviceOptions& options);
/// Options of all devices.
void describe(OptionSet& set, DeviceOptions& options);

/// Devices of a recording; `glove` is nullptr if none is recorded.
struct Devices {
  std::unique_ptr<GloveSource> glove;
  std::vector<std::unique_ptr<CameraSource>> cameras;

  GloveStatus glove_status() const { return glove ? glove->status() : GloveStatus{}; }
  std::vector<RecordSource*> sources() const;
};

/// Opens the devices and describes them in `session`. Throws usage_error if there are none.
Devices open_devices(const DeviceOptions& options, SessionInfo& session);

}  // namespace touchtrace::cli
