#include "calib/smooth/variance_factors.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace touchtrace {
namespace {

/// Phases that affect how well the noise model fits; indices of VarianceFactors::phases_.
enum class Phase { contact, before_throw };

/// Before a release: wind-up, whose last part counts as part of the flight. After a landing the
/// hand settles.
constexpr double wind_up_duration_s = 0.55, release_margin_s = 0.07, settling_duration_s = 0.3;
constexpr double min_residuals = 100.0;
/// Hands in simulated scenes are this smooth; a smaller factor means that the positions were not
/// measured independently.
constexpr double min_factor = 0.4;
/// Minimum fraction of a measurement's variance in its residual. Below it, no other measurement
/// predicts the measured value.
constexpr double min_residual_variance_fraction = 0.02;

/// Nullopt in flight and near its ends.
std::optional<Phase> phase_at(const std::vector<Flight>& flights, double time_s) {
  Phase phase = Phase::contact;
  for (const auto& flight : flights) {
    if (time_s > flight.release_s - release_margin_s &&
        time_s < flight.landing_s + settling_duration_s)
      return std::nullopt;
    if (time_s < flight.release_s && time_s > flight.release_s - wind_up_duration_s)
      phase = Phase::before_throw;
  }
  return phase;
}

}  // namespace

double VarianceFactors::Residuals::mean_or_1() const {
  return count < min_residuals ? 1.0 : sum_of_squares / count;
}

void VarianceFactors::add(const WeightedTrack& track, const Trajectory& trajectory,
                          double expected_mean_square) {
  const auto predicted = trajectory.predicted_measurements();
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const auto phase = phase_at(track.flights, track.points[i].time_s);
    if (!phase) continue;
    auto& [sum_of_squares, count] = phases_[static_cast<std::size_t>(*phase)];
    for (int axis = 0; axis < 3; ++axis) {
      const double variance = predicted[i].white_variance_m2[axis] / track.weights[i],
                   residual_variance = variance - predicted[i].variance_m2[axis],
                   residual = track.points[i].position_m[axis] - predicted[i].position_m[axis];
      if (!(residual_variance > min_residual_variance_fraction * variance)) continue;
      sum_of_squares += residual * residual / residual_variance / expected_mean_square;
      count += 1.0;
    }
  }
}

void VarianceFactors::add(const VarianceFactors& other) {
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    phases_[i].sum_of_squares += other.phases_[i].sum_of_squares;
    phases_[i].count += other.phases_[i].count;
  }
}

double VarianceFactors::at(const std::vector<Flight>& flights, double time_s) const {
  const auto phase = phase_at(flights, time_s);
  if (!phase) return 1.0;
  const double factor = phases_[static_cast<std::size_t>(*phase)].mean_or_1();
  return std::max(*phase == Phase::contact ? min_factor : 1.0, factor);
}

}  // namespace touchtrace
