#pragma once

#include "calib/rgbd/calibration.h"
#include "engine/base/options.h"
#include "pipeline/label/scene_model.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace::label {

struct LabelOptions {
  /// "csrt": as in the paper; "csrt-fast": smaller template, fewer scales; "kcf"; "component":
  /// colour and depth alone, much faster.
  std::string tracker = "csrt-fast";
  int threads = 0;  ///< 0: one a core
};

void describe(OptionSet& set, LabelOptions& options);

/// Hand and object of a recording at every frame of its first glove: segment, follow, lift, align,
/// smooth. Reads nothing of a recording's truth. The result does not depend on the number of
/// threads.
///
/// A label's time is the middle of the glove frame's scan on the host's clock, up to the least
/// latency of either stream, which stamps cannot show; `summary` says so and gives clocks, noise,
/// shares and seconds. Throws data_error for a recording without glove, camera frames, clips or
/// background, or whose boxes lead nowhere.
Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const RgbdCalibration& calibration, const LabelOptions& options);

/// A recording's images, read as they are needed. The reader must outlive them.
FrameSource frames_of(const RecordingReader& reader);

/// The same of a file.
Labels label_recording(const RecordingReader& reader, const RgbdCalibration& calibration,
                       const LabelOptions& options);

}  // namespace touchtrace::label
