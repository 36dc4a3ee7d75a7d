#pragma once

#include "calib/rgbd/calibration.h"
#include "engine/base/options.h"
#include "pipeline/label/scene_model.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace::label {

struct LabelOptions {
  /// "csrt": OpenCV's defaults; "csrt-fast": smaller template, fewer scales; "kcf"; "component":
  /// colour and depth only, fastest.
  std::string tracker = "csrt-fast";
  int num_threads = 0;  ///< 0: one per core; does not change the result
};

void describe(OptionSet& set, LabelOptions& options);

/// Labels hand and object of a recording at every frame of its first glove: segmentation, tracking,
/// shape fits, time alignment, smoothing. Does not read a recording's truth.
///
/// A label's time is the mid-scan time of its glove frame on the host's clock, up to the minimum
/// latency of both streams, which time stamps cannot show. Labels::summary has clocks, noise,
/// fractions of lost frames and times. Throws data_error for a recording without glove frames,
/// camera frames, clips, boxes or background frames, for boxes without hand or object, and if hand
/// or object are lost in half of the frames.
Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const RgbdCalibration& calibration, const LabelOptions& options);

/// Labels a recording file.
Labels label_recording(const RecordingReader& reader, const RgbdCalibration& calibration,
                       const LabelOptions& options);

/// Images of a recording file, read on demand. The reader must outlive the result.
FrameSource frame_source(const RecordingReader& reader);

}  // namespace touchtrace::label
