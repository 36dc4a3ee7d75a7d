#pragma once

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {

/// The clips of one synthetic activity that smoothing is measured on.
struct SmoothingSample {
  static constexpr double rate_hz = 20.0, noise_m = 0.002, clip_s = 40.0;
  static constexpr int clips = 6;

  std::vector<SyntheticMotion> motions;
  std::vector<Track> tracks;
  std::vector<std::vector<Flight>> flights;  ///< as labelling guesses them: 30 ms off
};

SmoothingSample smoothing_sample(SyntheticMotion (*make)(double seconds, std::uint64_t seed));

}  // namespace touchtrace
