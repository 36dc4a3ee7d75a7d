#pragma once

#include <functional>

#include "calib/rgbd/calibration.h"
#include "engine/base/options.h"
#include "pipeline/label/learn/scene_model.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace::label {

struct LabelOptions {
  std::string tracker = "csrt";  ///< or "component": colour and depth alone, faster
  /// "auto": masks if half of the frames have one, else depth-color with the masks that there are.
  std::string observer = "auto";
  bool no_flights = false;  ///< the object never leaves the hand
  /// [2] Delay from the middle of the exposure to the camera's time stamp and its standard
  /// deviation; empty: see align(), latency_from_catches() and
  /// latency_from_touch().
  std::vector<double> camera_latency_s;
  /// [3] in the colour camera's frame; empty: from the camera's accelerometer, else 9.81 m/s^2
  /// along the image's vertical axis.
  std::vector<double> gravity_m_per_s2;
  int num_threads = 0;  ///< 0: one per core; does not change the result
};

void describe(OptionSet& set, LabelOptions& options);
/// Option --tracker alone.
Option& describe_tracker(OptionSet& set, LabelOptions& options);

/// Labels hand and object of a recording at every frame of its first glove, or of the camera if it
/// has none: segmentation, tracking, shape fits, time alignment, smoothing. Does not read a
/// recording's truth.
///
/// A label's time is the mid-scan time of its glove frame on the host's clock, up to the glove's
/// minimum latency, which time stamps cannot show. Labels::summary has clocks, noise,
/// fractions of lost frames, times, and why clips were not labelled. `calibration`: nullopt or
/// incomplete: see camera_calibration(). Throws data_error for a recording without camera frames,
/// for a calibration of other images, and if no clip can be labelled: after tracking, `on_refusal`
/// first gets labels with the measured positions alone.
Labels label_recording(const Recording& recording, const FrameSource& frames,
                       const std::optional<RgbdCalibration>& calibration,
                       const LabelOptions& options,
                       const std::function<void(const Labels&)>& on_refusal = {});

/// Labels a recording file.
Labels label_recording(const RecordingReader& reader,
                       const std::optional<RgbdCalibration>& calibration,
                       const LabelOptions& options,
                       const std::function<void(const Labels&)>& on_refusal = {});

/// Images of a recording file, read on demand. The reader must outlive the result.
FrameSource frame_source(const RecordingReader& reader);

}  // namespace touchtrace::label
