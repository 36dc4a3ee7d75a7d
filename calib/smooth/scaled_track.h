#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// A measurement in MotionUnits. What it is off by more than is usual is its own: another part of
/// the body shows. As a multiple of its neighbours' errors it would pull at them.
struct ScaledPoint {
  double time;
  Eigen::Vector3d position, sigma;
  Eigen::Vector3d usual_sigma;  ///< no more than `sigma`
  double weight;

  /// Deviation of the errors that its neighbours have, too.
  template <class T>
  Eigen::Matrix<T, 3, 1> correlated_sigma(const MotionNoise<T>& noise) const {
    return noise.correlated_scale * usual_sigma.cast<T>();
  }

  /// Variance of the errors that no neighbour has, before the weight divides it.
  template <class T>
  Eigen::Matrix<T, 3, 1> own_variance(const MotionNoise<T>& noise) const {
    const T white = noise.measurement_scale * noise.measurement_scale,
            correlated = noise.correlated_scale * noise.correlated_scale;
    const Eigen::Vector3d variance = sigma.cwiseAbs2(), usual = usual_sigma.cwiseAbs2();
    return white * variance.cast<T>() + correlated * (variance - usual).cast<T>();
  }
};

/// A track from its own first time and place: what filters and Ceres see.
struct ScaledTrack : std::vector<ScaledPoint> {
  double extent = 0.0;  ///< largest distance from the first point along an axis

  ScaledTrack(const WeightedTrack& track, const MotionUnits& units) {
    const auto& first = track.points.front();
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      const auto& from = track.points[i];
      const Eigen::Vector3d sigma = from.sigma_m / units.length_m;
      push_back({(from.time_s - first.time_s) / units.time_s,
                 (from.position_m - first.position_m) / units.length_m, sigma,
                 sigma.cwiseMin(units.usual_sigma), track.weights[i]});
      extent = std::max(extent, back().position.cwiseAbs().maxCoeff());
    }
  }
};

/// Release and landing in turn, in time units from `origin_s`; none before the one before it, as
/// times that are moved by their deviations might be.
inline std::vector<ContactEvent<double>> contact_events(const std::vector<Flight>& flights,
                                                        double origin_s, double unit_s) {
  std::vector<ContactEvent<double>> events;
  double last = -std::numeric_limits<double>::infinity();
  const auto add = [&](double time_s, bool release) {
    last = std::max(last, (time_s - origin_s) / unit_s);
    events.push_back({last, release});
  };
  for (const auto& flight : flights) add(flight.release_s, true), add(flight.landing_s, false);
  return events;
}

/// In the track's units.
InitialMotion scaled(const InitialMotion& initial, const MotionUnits& units);

/// The filter's state before the first measurement of some axes; everything in the track's units.
template <class Body>
Body initial_state(const ScaledTrack& track, Eigen::Index first_axis,
                   const InitialMotion& initial) {
  constexpr double wide = 1e3;  // in deviations of a measurement; more is lost to rounding
  constexpr int axes = Body::axes;
  Body state;
  if constexpr (Body::correlated) state.covariance.diagonal().template tail<axes>().setOnes();
  for (Eigen::Index i = 0; i < axes; ++i) {
    const double spread = std::max(wide * track.front().sigma[first_axis + i], track.extent);
    state.mean[i] = track.front().position[first_axis + i];
    state.covariance(i, i) = spread * spread;
    state.covariance(axes + i, axes + i) = std::pow(std::min(spread, initial.velocity_m_per_s), 2);
    state.covariance(2 * axes + i, 2 * axes + i) =
        std::pow(std::min(spread, initial.acceleration_m_per_s2), 2);
  }
  return state;
}

template <class T, Errors errors>
T innovation_cost_with(const ScaledTrack& track, const MotionPrior<T>& prior,
                       const Eigen::Vector3d& gravity, const InitialMotion& initial) {
  std::array<BodyState<T, 1, errors>, 3> now;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto start = initial_state<BodyState<double, 1, errors>>(track, axis, initial);
    now[static_cast<std::size_t>(axis)] = {start.mean.template cast<T>(),
                                           start.covariance.template cast<T>()};
  }
  T cost(0.0);
  double time = 0.0;
  for (const auto& point : track) {
    const auto step = prior.between(time, point.time);
    const Eigen::Matrix<T, 3, 1> variance = point.own_variance(prior.noise()) / T(point.weight),
                                 correlated = point.correlated_sigma(prior.noise());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      auto& state = now[static_cast<std::size_t>(axis)];
      state = state.after(step, gravity[axis]);
      cost += state.measure(point.position[axis], variance[axis], correlated[axis]);
    }
    time = point.time;
  }
  return cost;
}

/// -log of the likelihood of a track's innovations under `prior`, axis by axis, without the
/// constant.
template <class T>
T innovation_cost(const ScaledTrack& track, const MotionPrior<T>& prior,
                  const Eigen::Vector3d& gravity, const InitialMotion& initial) {
  if (prior.noise().correlated_scale > T(0))
    return innovation_cost_with<T, Errors::correlated>(track, prior, gravity, initial);
  return innovation_cost_with<T, Errors::white>(track, prior, gravity, initial);
}

}  // namespace touchtrace
