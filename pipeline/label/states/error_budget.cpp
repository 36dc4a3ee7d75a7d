#include "pipeline/label/states/error_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace::label {
namespace {

// README.md has the sources of these constants.
// Standard deviation per axis of the visible centroid about the palm's centre.
constexpr double hand_shape_m = 0.005;
// Standard deviation per axis of a hidden object's position in the hand.
constexpr double hidden_object_m = 0.02;
// Correlation time of that position as the hand turns.
constexpr double hidden_object_s = 0.4;

double square(double value) { return value * value; }

/// Observation of the found object nearest in time; null if there is none.
const Observation* nearest_found(double time_s, const ClipTrack& track) {
  const Observation* nearest = nullptr;
  double nearest_s = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::size_t i) {
    const double distance_s = std::abs(track.time_s[i] - time_s);
    if (track.object[i].found && distance_s < nearest_s)
      nearest_s = distance_s, nearest = &track.object[i];
    return track.object[i].found;
  };
  const auto at = static_cast<std::size_t>(std::ranges::lower_bound(track.time_s, time_s) -
                                           track.time_s.begin());
  for (std::size_t i = at; i < track.time_s.size() && !consider(i);) ++i;
  for (std::size_t i = at; i > 0 && !consider(i - 1);) --i;
  return nearest;
}

}  // namespace

/// Gauss-Hermite quadrature with three points, at -/+ sqrt(3) sigma with weight 1/6 each: exact for
/// a constant velocity, and large where the velocity jumps.
StateCovariance ErrorModel::latency_covariance(const SmoothedTrack& smoothed, double time_s,
                                               const MotionState& state) const {
  const double delay_s = std::sqrt(3.0) * latency_sigma_s_;
  StateCovariance covariance = StateCovariance::Zero();
  for (const double shift_s : {-delay_s, delay_s}) {
    const MotionState delayed = smoothed.smoothed(time_s + shift_s);
    Eigen::Matrix<double, 6, 1> difference;
    difference << delayed.position_m - state.position_m,
        delayed.velocity_m_per_s - state.velocity_m_per_s;
    covariance += difference * difference.transpose() / 6.0;
  }
  return covariance;
}

ErrorBudget ErrorModel::common(const SmoothedTrack& smoothed, double time_s) const {
  const MotionState state = smoothed.smoothed(time_s);
  ErrorBudget budget;
  budget[ErrorSource::smoothing] = state.covariance.topLeftCorner<6, 6>();
  budget[ErrorSource::calibration] =
      calibration_.covariance(state.position_m, state.velocity_m_per_s);
  budget[ErrorSource::latency] = latency_covariance(smoothed, time_s, state);
  return budget;
}

ErrorBudget ErrorModel::hand(const SmoothedTrack& smoothed, double time_s) const {
  ErrorBudget budget = common(smoothed, time_s);
  budget[ErrorSource::shape].diagonal().head<3>().setConstant(square(hand_shape_m));
  return budget;
}

ErrorBudget ErrorModel::object(const SmoothedTrack& smoothed, double time_s, const ClipTrack& track,
                               const MotionNoise& noise) const {
  ErrorBudget budget = common(smoothed, time_s);
  auto shape = budget[ErrorSource::shape].diagonal();
  shape.head<3>().setConstant(square(track.object_centre_sigma_m));
  const Observation* nearest = nearest_found(time_s, track);
  if (!nearest) return budget;
  // The smoother's covariance contains the correlated part.
  budget[ErrorSource::correlated].diagonal().head<3>() =
      (noise.unexplained_variance_fraction() - noise.correlated_variance_fraction()) *
      nearest->sigma_m.cwiseAbs2();
  if (nearest->follows_hand) {
    shape.head<3>().array() += square(hidden_object_m);
    shape.tail<3>().array() += square(hidden_object_m / hidden_object_s);
  }
  return budget;
}

Eigen::Vector3d ErrorModel::measured_sigma_m(const Observation& observation,
                                             const SmoothedTrack& smoothed, double time_s,
                                             const MotionNoise& noise, double shape_m2) const {
  ErrorBudget budget = common(smoothed, time_s);
  const Eigen::Vector3d variance =
      std::max(1.0, square(noise.measurement_scale)) * observation.sigma_m.cwiseAbs2() +
      budget[ErrorSource::calibration].diagonal().head<3>() +
      budget[ErrorSource::latency].diagonal().head<3>();
  return (variance.array() + shape_m2).sqrt();
}

Eigen::Vector3d ErrorModel::measured_hand_sigma_m(const Observation& observation,
                                                  const SmoothedTrack& smoothed, double time_s,
                                                  const MotionNoise& noise) const {
  return measured_sigma_m(observation, smoothed, time_s, noise, square(hand_shape_m));
}

Eigen::Vector3d ErrorModel::measured_object_sigma_m(const Observation& observation,
                                                    const SmoothedTrack& smoothed, double time_s,
                                                    const ClipTrack& track,
                                                    const MotionNoise& noise) const {
  const double hidden_m2 = observation.follows_hand ? square(hidden_object_m) : 0.0;
  return measured_sigma_m(observation, smoothed, time_s, noise,
                          square(track.object_centre_sigma_m) + hidden_m2);
}

}  // namespace touchtrace::label
