#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/smooth/trajectory.h"

namespace touchtrace {

/// A track in MotionUnits from its own first time and place: what filters and Ceres see.
struct ScaledPoint {
  double time;
  std::array<double, 3> position, sigma;
};

struct ScaledTrack : std::vector<ScaledPoint> {
  double extent = 0.0;  ///< largest distance from the first point along an axis

  ScaledTrack(const Track& track, const std::vector<double>& weights, const MotionUnits& units) {
    reserve(track.size());
    for (std::size_t i = 0; i < track.size(); ++i) {
      ScaledPoint point{(track[i].time_s - track.front().time_s) / units.time_s, {}, {}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        point.position[axis] =
            (track[i].position_m[k] - track.front().position_m[k]) / units.length_m;
        point.sigma[axis] = track[i].sigma_m[k] / units.length_m / std::sqrt(weights[i]);
        extent = std::max(extent, std::abs(point.position[axis]));
      }
      push_back(point);
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

/// The filter's state before the first measurement of one axis; everything in the track's units.
AxisState<double> initial_state(const ScaledTrack& track, std::size_t axis,
                                const InitialMotion& initial);

/// -log of the likelihood of a track's innovations under `prior`, without the constant.
template <class T>
T innovation_cost(const ScaledTrack& track, const MotionPrior<T>& prior,
                  const Eigen::Vector3d& gravity, const InitialMotion& initial) {
  std::array<AxisState<T>, 3> now;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto start = initial_state(track, axis, initial);
    now[axis] = {start.mean.template cast<T>(), start.covariance.template cast<T>()};
  }
  const T scale2 = prior.noise().measurement_scale * prior.noise().measurement_scale;
  T cost(0.0);
  double time = 0.0;
  for (const auto& point : track) {
    const auto step = prior.between(time, point.time);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      now[axis] = now[axis].after(step, gravity[static_cast<Eigen::Index>(axis)]);
      cost += now[axis].measure(point.position[axis],
                                T(point.sigma[axis] * point.sigma[axis]) * scale2);
    }
    time = point.time;
  }
  return cost;
}

}  // namespace touchtrace
