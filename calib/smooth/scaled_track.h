#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// Measurement in MotionUnits.
struct ScaledPoint {
  double time;
  Eigen::Vector3d position, sigma;
  /// min(sigma, the axis' median). What a sigma has beyond the median belongs to this measurement
  /// alone (another part of the body is visible), so correlated errors do not scale with it:
  /// otherwise one bad measurement would bias its neighbours.
  Eigen::Vector3d typical_sigma;
  double weight;

  /// Standard deviation of the correlated error.
  template <class T>
  Eigen::Matrix<T, 3, 1> correlated_sigma(const MotionNoise<T>& noise) const {
    return noise.correlated_scale * typical_sigma.cast<T>();
  }

  /// Variance of the white error, not divided by the weight.
  template <class T>
  Eigen::Matrix<T, 3, 1> white_variance(const MotionNoise<T>& noise) const {
    const T white = noise.measurement_scale * noise.measurement_scale,
            correlated = noise.correlated_scale * noise.correlated_scale;
    const Eigen::Vector3d variance = sigma.cwiseAbs2(), typical = typical_sigma.cwiseAbs2();
    return white * variance.cast<T>() + correlated * (variance - typical).cast<T>();
  }
};

/// Track in MotionUnits relative to its first time and position: the filters' and Ceres' input.
struct ScaledTrack : std::vector<ScaledPoint> {
  double extent = 0.0;  ///< largest distance from the first point along an axis

  ScaledTrack(const WeightedTrack& track, const MotionUnits& units) {
    const auto& first = track.points.front();
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      const auto& point = track.points[i];
      const Eigen::Vector3d sigma = point.sigma_m / units.length_m;
      push_back({(point.time_s - first.time_s) / units.time_s,
                 (point.position_m - first.position_m) / units.length_m, sigma,
                 sigma.cwiseMin(units.median_sigma), track.weights[i]});
      extent = std::max(extent, back().position.cwiseAbs().maxCoeff());
    }
  }
};

/// Alternating releases and landings in units of `unit_s` from `origin_s`. Times are made
/// non-decreasing: drawing them from their distributions may swap neighbours.
inline std::vector<ContactEvent<double>> contact_events(const std::vector<Flight>& flights,
                                                        double origin_s, double unit_s) {
  std::vector<ContactEvent<double>> events;
  double last = -std::numeric_limits<double>::infinity();
  const auto add = [&](double time_s, bool is_release) {
    last = std::max(last, (time_s - origin_s) / unit_s);
    events.push_back({last, is_release});
  };
  for (const auto& flight : flights) add(flight.release_s, true), add(flight.landing_s, false);
  return events;
}

/// Converts to the track's units.
InitialMotion scaled(const InitialMotion& initial, const MotionUnits& units);

/// Filter state before the first measurement, in the track's units.
template <class State>
State initial_state(const ScaledTrack& track, Eigen::Index first_axis,
                    const InitialMotion& initial) {
  constexpr double flat = 1e3;  // in sigmas of a measurement; more loses digits to rounding
  constexpr int axes = State::axes;
  State state;
  if constexpr (State::has_correlated_errors)
    state.covariance.diagonal().template tail<axes>().setOnes();
  for (Eigen::Index i = 0; i < axes; ++i) {
    const double sigma = std::max(flat * track.front().sigma[first_axis + i], track.extent);
    state.mean[i] = track.front().position[first_axis + i];
    state.covariance(i, i) = sigma * sigma;
    state.covariance(axes + i, axes + i) =
        std::pow(std::min(sigma, initial.velocity_sigma_m_per_s), 2);
    state.covariance(2 * axes + i, 2 * axes + i) =
        std::pow(std::min(sigma, initial.acceleration_sigma_m_per_s2), 2);
  }
  return state;
}

/// See negative_log_likelihood; with correlated errors only if `errors` says so.
template <class T, ErrorModel errors>
T negative_log_likelihood_with(const ScaledTrack& track, const MotionPrior<T>& prior,
                               const Eigen::Vector3d& gravity, const InitialMotion& initial) {
  std::array<KalmanState<T, 1, errors>, 3> states;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto start = initial_state<KalmanState<double, 1, errors>>(track, axis, initial);
    states[static_cast<std::size_t>(axis)] = {start.mean.template cast<T>(),
                                              start.covariance.template cast<T>()};
  }
  T cost(0.0);
  double time = 0.0;
  for (const auto& point : track) {
    const auto step = prior.between(time, point.time);
    const Eigen::Matrix<T, 3, 1> variance = point.white_variance(prior.noise()) / T(point.weight),
                                 correlated = point.correlated_sigma(prior.noise());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      auto& state = states[static_cast<std::size_t>(axis)];
      state = state.predict(step, gravity[axis]);
      cost += state.update(point.position[axis], variance[axis], correlated[axis]);
    }
    time = point.time;
  }
  return cost;
}

/// Negative log-likelihood of a track's innovations under `prior`, with independent axes, without
/// its constant.
template <class T>
T negative_log_likelihood(const ScaledTrack& track, const MotionPrior<T>& prior,
                          const Eigen::Vector3d& gravity, const InitialMotion& initial) {
  if (prior.noise().correlated_scale > T(0))
    return negative_log_likelihood_with<T, ErrorModel::correlated>(track, prior, gravity, initial);
  return negative_log_likelihood_with<T, ErrorModel::white>(track, prior, gravity, initial);
}

}  // namespace touchtrace
