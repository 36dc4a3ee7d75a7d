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
  std::string glove, glove_config, protocol = "actionsense", camera, depth_camera;
  int baud = 0, rows = 0, cols = 0, bits = 0, polarity = 0;
  double rate_hz = 0.0, speed = 1.0;
  CameraSourceOptions images;
};

/// `--protocol`
void describe_protocol(OptionSet& set, std::string& protocol);
/// Options of a glove whose properties are not known yet, and `--speed`.
void describe_glove(OptionSet& set, DeviceOptions& options);
/// The same, and `--glove-config`.
void describe_known_glove(OptionSet& set, DeviceOptions& options);
/// Options of cameras, but for `--speed`.
void describe_cameras(OptionSet& set, DeviceOptions& options);
/// Options of all devices.
void describe(OptionSet& set, DeviceOptions& options);

/// Devices of a recording; `glove` is nullptr if none is recorded.
struct Devices {
  std::unique_ptr<GloveSource> glove;
  std::vector<std::unique_ptr<CameraSource>> cameras;

  GloveStatus glove_status() const { return glove ? glove->status() : GloveStatus{}; }
  /// The glove, if there is one, and the cameras.
  std::vector<RecordSource*> sources() const;
};

/// Glove as the options describe it, then `--glove-config`, then the protocol. It has a baseline if
/// the file is given. Warns of a glove that is not fit for use.
GloveInfo glove_info(const DeviceOptions& options);
/// Opens the glove's port. `start_s`: time of monotonic_s() that is 0 in its frames.
std::unique_ptr<GloveSource> open_glove(const DeviceOptions& options, const GloveInfo& info,
                                        double start_s);
/// Opens the cameras, which may be none. `start_s`: time of monotonic_s() that is 0 in their
/// frames.
std::vector<std::unique_ptr<CameraSource>> open_cameras(const DeviceOptions& options,
                                                        double start_s);
/// Throws data_error, with a reason, if the glove has sent no frame. `port`: for the message.
void require_glove_frames(const ParserCounts& glove, const std::string& port);
/// "15.002 Hz, 300 frames, ..."
std::string glove_text(const GloveStatus& glove);

/// Opens the devices and describes them in `session`. Throws usage_error if there are none.
Devices open_devices(const DeviceOptions& options, SessionInfo& session);

}  // namespace touchtrace::cli
