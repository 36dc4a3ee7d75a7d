#pragma once

#include <vector>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// True clock of the camera: device time = offset + (1 + drift) host time.
struct CameraClock {
  double period_s = 0.05;  ///< device clock
  double offset_s = 0.0, drift = 0.0;
  double latency_s = 0.0;   ///< shortest time from the middle of the exposure to the arrival
  double jitter_s = 0.0;    ///< mean of the exponential part of the latency
  double drop_share = 0.0;  ///< probability that a frame is dropped; sequence numbers continue
  std::uint64_t seed = 0;

  double device_time_s(std::uint64_t sequence) const {
    return static_cast<double>(sequence) * period_s;
  }
  /// Host time of the middle of the exposure; not observable from the stamps.
  double true_time_s(std::uint64_t sequence) const {
    return (device_time_s(sequence) - offset_s) / (1.0 + drift);
  }
  double arrival_s(std::uint64_t sequence) const;
  bool is_dropped(std::uint64_t sequence) const;
  /// Frames exposed from `start_s` to `end_s` (host clock) that are not dropped.
  std::vector<std::uint64_t> frames_between(double start_s, double end_s) const;
};

/// Draws the clock of `options.seed`: an offset of seconds, a drift of tens of ppm.
CameraClock make_camera_clock(const SceneOptions& options);

/// Truth::clocks["camera"].
nlohmann::json clock_truth(const CameraClock& clock);

}  // namespace touchtrace::scene
