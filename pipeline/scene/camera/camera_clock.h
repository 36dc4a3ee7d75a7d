#pragma once

#include <vector>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// When the camera exposes, by its own clock and by the host's: device = offset + (1 + drift) host.
struct CameraClock {
  double period_s = 0.05;  ///< by its own clock
  double offset_s = 0.0, drift = 0.0;
  double latency_s = 0.0;   ///< least time from the middle of the exposure to the arrival
  double jitter_s = 0.0;    ///< mean of the exponential part of the latency
  double drop_share = 0.0;  ///< of the frames; the sequence numbers go on
  std::uint64_t seed = 0;

  double device_time_s(std::uint64_t sequence) const {
    return static_cast<double>(sequence) * period_s;
  }
  /// Host's time of the middle of the exposure; what the stamps do not tell.
  double true_time_s(std::uint64_t sequence) const {
    return (device_time_s(sequence) - offset_s) / (1.0 + drift);
  }
  double arrival_s(std::uint64_t sequence) const;
  bool dropped(std::uint64_t sequence) const;
  /// The frames exposed from `start_s` to `end_s` (host) that were not dropped.
  std::vector<std::uint64_t> frames_between(double start_s, double end_s) const;
};

/// Offset of seconds, drift of tens of ppm: another one for each seed.
CameraClock make_camera_clock(const SceneOptions& options);

/// Truth::clocks["camera"].
nlohmann::json clock_truth(const CameraClock& clock);

}  // namespace touchtrace::scene
