#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// How regularly the frames of a stream arrived. Clips are looked at one by one; without clips, the
/// whole stream is one.
struct StreamTiming {
  std::size_t frames = 0;
  std::size_t lost = 0;   ///< counted by the device within clips but never received
  double rate_hz = 0.0;   ///< of the counter against the host's clock; NaN for less than 3 frames
  double jitter_s = 0.0;  ///< deviation of the arrival stamps from a constant rate

  double lost_share() const;
};

StreamTiming timing_of(const std::vector<std::uint64_t>& sequence,
                       const std::vector<double>& host_time_s, const std::vector<Clip>& clips);

/// What the taxels of a glove said. Shares are of the frames.
struct TactileCheck {
  int taxels = 0;            ///< that the mask leaves
  int dead_taxels = 0;       ///< that never changed
  double zero_frames = 0.0;  ///< no taxel counted anything
  double saturated_frames =
      0.0;  ///< more than half of the taxels at the end of the converter's range

  /// What makes the glove useless for training; empty if nothing does.
  std::vector<std::string> faults() const;
};

TactileCheck check_tactile(const GloveStream& glove);

nlohmann::json to_json(const StreamTiming& timing);
nlohmann::json to_json(const TactileCheck& check);

}  // namespace touchtrace
