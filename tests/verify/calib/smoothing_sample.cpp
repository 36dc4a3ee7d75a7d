#include "tests/verify/calib/smoothing_sample.h"

namespace touchtrace {
namespace {

/// Flights 30 ms too short on both sides; a hit remains a single event.
std::vector<Flight> guess_flights(const std::vector<Flight>& flights) {
  constexpr double error_s = 0.03;
  auto guess = flights;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const bool hit = i > 0 && flights[i].release_s <= flights[i - 1].landing_s;
    guess[i].landing_s -= error_s;
    guess[i].release_s = hit ? guess[i - 1].landing_s : guess[i].release_s + error_s;
  }
  return guess;
}

}  // namespace

SmoothingSample smoothing_sample(SyntheticMotion (*make)(double, std::uint64_t)) {
  SmoothingSample result;
  for (std::uint64_t seed = 0; seed < SmoothingSample::clips; ++seed) {
    const auto& motion = result.motions.emplace_back(make(SmoothingSample::clip_s, seed));
    result.tracks.push_back(
        measure(motion, SmoothingSample::rate_hz, SmoothingSample::noise_m, seed));
    result.flights.push_back(guess_flights(motion.flights));
  }
  return result;
}

}  // namespace touchtrace
