#include "calib/smooth/variance_factors.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace touchtrace {
namespace {

/// Before a release a throw is wound up, but for its last frames; after a landing a hand settles.
constexpr double winds_up_s = 0.55, releases_s = 0.07, settles_s = 0.3;
constexpr double fewest_residuals = 100.0;
/// As smooth as hands are in simulated scenes; less comes of positions that were not measured one
/// by one.
constexpr double least_factor = 0.4;
/// Of a measurement's variance: where less is left to a residual, nothing else foretells it.
constexpr double least_left = 0.02;

/// Nothing in flight and near its ends.
std::optional<Phase> phase_at(const std::vector<Flight>& flights, double time_s) {
  Phase phase = Phase::settled;
  for (const auto& [release_s, landing_s, releases, landings] : flights) {
    if (time_s > release_s - releases_s && time_s < landing_s + settles_s) return std::nullopt;
    if (time_s < release_s && time_s > release_s - winds_up_s) phase = Phase::winding_up;
  }
  return phase;
}

}  // namespace

double VarianceFactors::Residuals::mean_or_1() const {
  return count < fewest_residuals ? 1.0 : squares / count;
}

void VarianceFactors::add(const WeightedTrack& track, const Trajectory& trajectory, double usual) {
  const auto foretold = trajectory.foretold();
  for (std::size_t i = 0; i < foretold.size(); ++i) {
    const auto phase = phase_at(track.flights, track.points[i].time_s);
    if (!phase) continue;
    auto& [squares, count] = phases_[static_cast<std::size_t>(*phase)];
    for (int axis = 0; axis < 3; ++axis) {
      const double variance = foretold[i].own_variance_m2[axis] / track.weights[i],
                   left = variance - foretold[i].variance_m2[axis],
                   residual = track.points[i].position_m[axis] - foretold[i].position_m[axis];
      if (!(left > least_left * variance)) continue;
      squares += residual * residual / left / usual;
      count += 1.0;
    }
  }
}

void VarianceFactors::add(const VarianceFactors& others) {
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    phases_[i].squares += others.phases_[i].squares;
    phases_[i].count += others.phases_[i].count;
  }
}

double VarianceFactors::at(const std::vector<Flight>& flights, double time_s) const {
  const auto phase = phase_at(flights, time_s);
  if (!phase) return 1.0;
  const double factor = phases_[static_cast<std::size_t>(*phase)].mean_or_1();
  return std::max(*phase == Phase::settled ? least_factor : 1.0, factor);
}

}  // namespace touchtrace
