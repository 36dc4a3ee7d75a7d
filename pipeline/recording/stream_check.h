#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Timing of a stream's frames.
struct StreamTiming {
  std::size_t frames = 0;
  std::size_t clip_frames = 0;  ///< within clips
  std::size_t lost = 0;         ///< within clips: counted by the device, not received
  double rate_hz = 0.0;         ///< of the frame counter by the host's clock; NaN below 3 frames
  double jitter_s = 0.0;        ///< standard deviation of arrival times around a constant rate

  double lost_fraction() const;
};

/// Fits host time = offset + sequence / rate by least squares, with one offset per clip. Without
/// clips, the whole stream is one.
StreamTiming measure_stream_timing(const std::vector<std::uint64_t>& sequence,
                                   const std::vector<double>& host_time_s,
                                   const std::vector<Clip>& clips);

/// Rate of a glove's frames by the host's clock; rate_hz if they are too few.
double measured_rate_hz(const GloveStream& glove, const std::vector<Clip>& clips);

/// Plausibility of a glove's counts. A taxel is saturated at its highest possible pressure.
struct TactileCheck {
  int taxels = 0;                 ///< in the mask
  int dead_taxels = 0;            ///< with constant counts
  double zero_frames = 0.0;       ///< fraction of the frames: all counts 0
  double saturated_frames = 0.0;  ///< fraction of the frames: over half of the taxels saturated
  double rest_level = 0.0;        ///< mean pressure in quiet frames, fraction of the range
  double repeated_frames = 0.0;   ///< fraction of the frames that equal their predecessor
  double frozen_s = 0.0;          ///< longest time without a change of any taxel
  int stuck_taxels = 0, stuck_rows = 0, stuck_cols = 0;  ///< saturated in nearly all frames
  int dead_rows = 0, dead_cols = 0;                      ///< with constant counts
  int upsampling = 1;       ///< of n frames, all but one are interpolated or repeated
  double used_range = 0.0;  ///< largest count, fraction of the range
  /// Fraction of the squared pressure that negative pressures have.
  double negative_pressure_fraction = 0.0;

  /// Reasons why the glove cannot be used for training.
  std::vector<std::string> faults() const;
  /// Values that hint at a wrong baseline, polarity or rate, or at a defect.
  std::vector<std::string> warnings() const;
};

TactileCheck check_tactile(const GloveStream& glove);

nlohmann::json to_json(const StreamTiming& timing);
nlohmann::json to_json(const TactileCheck& check);

}  // namespace touchtrace
