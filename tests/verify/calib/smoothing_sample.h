#pragma once

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {

/// Clips of one synthetic activity on which smoothing is measured.
struct SmoothingSample {
  static constexpr double rate_hz = 20.0, noise_m = 0.002, clip_s = 40.0;
  static constexpr int clips = 6;

  std::vector<SyntheticMotion> motions;
  std::vector<Track> tracks;
  std::vector<std::vector<Flight>>
      flights;  ///< guesses that are 30 ms off, like those of labelling
};

SmoothingSample smoothing_sample(SyntheticMotion (*make)(double seconds, std::uint64_t seed));

}  // namespace touchtrace
