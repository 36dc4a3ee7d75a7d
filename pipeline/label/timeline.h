#pragma once

#include <vector>

#include "calib/smooth/clock.h"
#include "pipeline/label/scene_model.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Both streams on the host's clock, each up to its least latency.
struct Timeline {
  ClockFit camera, glove;             ///< glove: of sequence / nominal rate
  std::vector<double> camera_time_s;  ///< [camera frames], when the image was taken
  double glove_scan_s = 0.0, glove_rate_hz = 15.0;

  /// The middle of the scan of the glove's frame number `sequence`.
  double glove_time_s(std::uint64_t sequence) const;
};

/// The glove's part of it. Throws data_error for a recording without glove frames or clips.
Timeline align_glove(const Recording& recording);
/// Throws data_error for a recording without camera frames, too.
Timeline align(const Recording& recording);

/// One glove frame to be labelled; index -1: lost on the way.
struct GloveFrame {
  double time_s;
  std::int32_t clip;
  std::int64_t index;
};

/// Every frame of the first glove's counter within a clip, lost ones included, clip after clip;
/// clips in which the object fell are left out.
std::vector<GloveFrame> glove_frames(const Recording& recording, const Timeline& timeline);

/// The camera frames of each clip.
std::vector<ClipFrames> clip_frames(const Recording& recording, const Timeline& timeline);

}  // namespace touchtrace::label
