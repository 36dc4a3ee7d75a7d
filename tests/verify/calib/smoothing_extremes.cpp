#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/smoothing_figures.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

constexpr double frame_s = 0.05, track_s = 10.0, usual_density = 300.0;

Track wave() { return measure(synthetic_wave(track_s, 1), 1.0 / frame_s, 0.002, 1); }

SmoothOptions linear(double jerk_density) {
  SmoothOptions options;
  options.estimate_noise = options.robust = false;
  options.noise.jerk_density = jerk_density, options.noise.bandwidth_rad_per_s = 0.0;
  return options;
}

/// Largest difference [m, m/s] between the motion smoothed in other units and in metres and
/// seconds.
double difference_in_units(double meters, double units_of_time, double origin_s) {
  const auto reference = smooth(wave(), linear(usual_density));
  const auto other = smooth(rescaled(wave(), meters, units_of_time, origin_s),
                            linear(usual_density * meters * meters / std::pow(units_of_time, 5)));
  double worst = 0.0;
  for (double t = 0.3; t < track_s - 1.0; t += 0.0731) {
    const auto a = other.smoothed(origin_s + units_of_time * t), b = reference.smoothed(t);
    worst = std::max({worst, (a.position_m / meters - b.position_m).norm(),
                      (a.velocity_m_per_s * units_of_time / meters - b.velocity_m_per_s).norm()});
  }
  return worst;
}

/// Whether a track is reported as converged although a state is not finite, less certain than a
/// measurement, or farther away than the motion's extent.
bool is_silently_wrong(const SmoothedTrack& smoothed, const Track& track) {
  if (smoothed.status != SmoothStatus::converged) return false;
  return !std::ranges::all_of(track, [&](const TrackPoint& point) {
    const auto state = smoothed.smoothed(point.time_s);
    const double sigma = point.sigma_m.x();
    return state.covariance.allFinite() && state.covariance(0, 0) > 0.0 &&
           std::sqrt(state.covariance(0, 0)) <= sigma * (1.0 + 1e-6) &&
           state.position_m.norm() < 0.5 && state.velocity_m_per_s.allFinite();
  });
}

/// Two frames at the same time, two a nanosecond apart, and half of the recording missing.
Track degraded_wave(double sigma_m) {
  auto track = wave();
  for (auto& point : track) point.sigma_m.setConstant(sigma_m);
  track[20].time_s = track[19].time_s;
  track[30].time_s = track[29].time_s + 1e-9;
  track.erase(track.begin() + 50, track.begin() + 150);
  return track;
}

void measure_stiffness(const std::function<void(Figure)>& emit) {
  double wrong = 0.0, refused = 0.0;
  for (int noise = -6; noise <= 6; noise += 3)
    for (int ratio = -9; ratio <= 9; ratio += 3) {
      const double sigma = std::pow(10.0, noise);
      const auto track = degraded_wave(sigma);
      const auto smoothed =
          smooth(track, linear(std::pow(10.0, ratio) * sigma * sigma / std::pow(frame_s, 5)));
      wrong += is_silently_wrong(smoothed, track);
      refused += smoothed.status != SmoothStatus::converged;
    }
  emit(
      at_most("noise 1e-6 to 1e6, prior to data 1e-9 to 1e9, equal times, gap: wrong but converged",
              wrong, "of 35", 0.0));
  emit(reported("the same: not converged", refused, "of 35"));
}

void measure_few_samples(const std::function<void(Figure)>& emit) {
  const auto track = wave();
  double wrong = smooth(Track{}, {}).status != SmoothStatus::no_samples;
  for (const std::ptrdiff_t count : {1, 2}) {
    const Track few(track.begin(), track.begin() + count);
    const auto smoothed = smooth(few, {});
    wrong += smoothed.status != SmoothStatus::converged || is_silently_wrong(smoothed, few);
  }
  emit(at_most("0, 1 and 2 samples: neither states nor an error status", wrong, "of 3", 0.0));
}

}  // namespace

void measure_extremes(const std::function<void(Figure)>& emit) {
  double worst = 0.0;
  for (const auto& [meters, units_of_time] : {std::pair{1e3, 1.0}, {1.0, 1e3}, {1e3, 1e3}})
    worst = std::max(worst, difference_in_units(meters, units_of_time, 0.0));
  emit(at_most("millimetres and milliseconds compared with metres and seconds", worst, "m, m/s",
               1e-9));
  // spacing of doubles 2.4e-7 s: 5e-7 m at 2 m/s, 7e-6 m/s at 30 m/s^2
  emit(at_most("times since the epoch compared with times from zero",
               difference_in_units(1.0, 1.0, 1.7e9), "m, m/s", 1e-5));
  measure_stiffness(emit);
  measure_few_samples(emit);
}

}  // namespace touchtrace
