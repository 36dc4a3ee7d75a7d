#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/smooth/clock.h"
#include "pipeline/label/learn/scene_model.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Largest latency of the camera that is looked for.
inline constexpr double max_latency_s = 0.35;

/// Estimate of the camera's latency.
struct LatencyEstimate {
  double latency_s, sigma_s;
  std::string source;  ///< "14 catches"
};

/// Camera and glove on the host's clock, each up to its minimum latency.
struct Timeline {
  ClockFit camera;
  std::vector<double> camera_time_s;  ///< [camera frames] when the image was taken
  std::optional<ClockFit> glove;      ///< device time is sequence / nominal rate; nullopt: no glove
  double glove_scan_s = 0.0, glove_rate_hz = 15.0;
  double latency_s = 0.0;        ///< of the camera, subtracted from camera_time_s
  double latency_sigma_s = 0.0;  ///< standard deviation of its error

  /// Mid-scan time of a glove frame.
  double glove_time_s(std::uint64_t sequence) const;
  /// Replaces the camera's latency; camera_time_s changes by the difference.
  void set_latency(double latency_s, double sigma_s);
};

/// Fits the glove's clock alone. Throws data_error for a recording without glove frames or clips,
/// or with a counter that is off its nominal rate by more than 5 %.
Timeline align_glove(const Recording& recording);
/// Fits the clocks of the camera and, if there is one, of the glove. A clock's offset includes the
/// stream's minimum latency. The glove's is taken as zero. With a glove, that of the camera is
/// taken as uniformly distributed between one and three frame periods (sources: README.md).
/// Throws data_error as align_glove, and for a recording without camera frames.
Timeline align(const Recording& recording);

/// Time to be labelled.
struct LabelTime {
  double time_s;
  std::int32_t clip;
  std::int64_t glove_frame;  ///< index in the stream; -1: lost in transmission, or no glove
};

/// Every counter value of the first glove inside a clip, lost frames included, clip after clip. In
/// a recording without glove, every camera frame. Clips in which the object fell are skipped.
std::vector<LabelTime> label_times(const Recording& recording, const Timeline& timeline);

/// Camera frames that arrived in each clip, and its boxes. No frames where the object fell; a
/// problem where the boxes have a fault.
std::vector<ClipFrames> clip_frames(const Recording& recording);

}  // namespace touchtrace::label
