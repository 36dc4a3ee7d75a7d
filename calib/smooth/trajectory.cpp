#include "calib/smooth/trajectory.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace touchtrace {

Trajectory::Trajectory(const WeightedTrack& track, const MotionNoise& noise,
                       const Eigen::Vector3d& gravity_m_per_s2)
    : units_(MotionUnits::of({track.points})),
      measurement_scale_(noise.measurement_scale),
      origin_s_(track.points.front().time_s),
      origin_m_(track.points.front().position_m),
      gravity_(gravity_m_per_s2 / units_.acceleration()) {
  const ScaledTrack scaled(track, units_);
  for (const auto& point : scaled.points) {
    times_.push_back(point.time);
    noise_scale_.push_back(std::exp(point.log_noise));
  }
  for (const auto& point : track.points) stated_variance_m2_.push_back(point.sigma_m.cwiseAbs2());
  if (track.flights.empty())
    knots_ = solve<StateModel::contact>(scaled, units_.scaled(noise));
  else
    knots_ = solve<StateModel::with_flights>(scaled, units_.scaled(noise));
}

template <StateModel model>
Trajectory::Knots<model> Trajectory::solve(const ScaledTrack& track,
                                           const MotionNoise& noise) const {
  Knots<model> knots{track.prior<model>(noise), {}, {}};
  const auto& points = track.points;
  auto step = knots.prior.initial(track.position_sigma);
  typename Knots<model>::States now;
  const double scale = noise.measurement_scale * noise.measurement_scale;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0) step = knots.prior.between(times_[k - 1], times_[k]);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      auto& state = now[static_cast<std::size_t>(axis)];
      state = state.predict(step, gravity_[axis], noise_scale_[k]);
      state.update(points[k].position[axis], scale * points[k].variance[axis]);
    }
    knots.filtered.push_back(now);
  }
  knots.smoothed = knots.filtered;
  for (std::size_t k = points.size() - 1; k-- > 0;) {
    step = knots.prior.between(times_[k], times_[k + 1]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      knots.smoothed[k][axis] =
          rts_step(knots.filtered[k][axis], step, gravity_[static_cast<Eigen::Index>(axis)],
                   noise_scale_[k + 1], knots.smoothed[k + 1][axis]);
  }
  return knots;
}

std::size_t Trajectory::knot_before(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(after - times_.begin()) - 1;
}

double Trajectory::noise_scale_at(double time) const {
  return noise_scale_[std::min(knot_before(time) + 1, times_.size() - 1)];
}

template <StateModel model>
typename Trajectory::Knots<model>::States Trajectory::filtered_at(const Knots<model>& knots,
                                                                  double time) const {
  const auto knot = knot_before(time);
  const auto step = knots.prior.between(times_[knot], time);
  auto states = knots.filtered[knot];
  for (std::size_t axis = 0; axis < 3; ++axis)
    states[axis] =
        states[axis].predict(step, gravity_[static_cast<Eigen::Index>(axis)], noise_scale_at(time));
  return states;
}

/// x(t) = F^-1 (x0 - w), in contact
template <StateModel model>
typename Trajectory::Knots<model>::States Trajectory::extrapolate_backwards(
    const Knots<model>& knots, double time) const {
  auto step = knots.prior.in_contact(times_.front() - time);
  const auto noise = step.Q;
  const Eigen::Matrix3d motion = step.F.template topLeftCorner<motion_size, motion_size>();
  step.F.template topLeftCorner<motion_size, motion_size>() = motion.inverse();
  step.Q.setZero();
  auto states = knots.smoothed.front();
  for (auto& state : states) {
    state.covariance += noise_scale_.front() * noise;
    state = state.predict(step, 0.0, 1.0);
  }
  return states;
}

template <StateModel model>
typename Trajectory::Knots<model>::States Trajectory::smoothed_at(const Knots<model>& knots,
                                                                  double time) const {
  if (time < times_.front()) return extrapolate_backwards(knots, time);
  const auto knot = knot_before(time);
  auto states = filtered_at(knots, time);
  if (knot + 1 == times_.size()) return states;
  const auto step = knots.prior.between(time, times_[knot + 1]);
  for (std::size_t axis = 0; axis < 3; ++axis)
    states[axis] = rts_step(states[axis], step, gravity_[static_cast<Eigen::Index>(axis)],
                            noise_scale_[knot + 1], knots.smoothed[knot + 1][axis]);
  return states;
}

MotionState Trajectory::smoothed(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  return std::visit([&](const auto& knots) { return to_metres(knots, smoothed_at(knots, time)); },
                    knots_);
}

MotionState Trajectory::causal(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  if (time < times_.front()) return smoothed(time_s);
  return std::visit([&](const auto& knots) { return to_metres(knots, filtered_at(knots, time)); },
                    knots_);
}

const Eigen::Vector3d& Trajectory::stated_variance_m2(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  std::size_t nearest = time < times_.front() ? 0 : knot_before(time);
  if (nearest + 1 < times_.size() && times_[nearest + 1] - time < time - times_[nearest]) ++nearest;
  return stated_variance_m2_[nearest];
}

std::vector<PredictedMeasurement> Trajectory::predicted_measurements() const {
  std::vector<PredictedMeasurement> result;
  std::visit(
      [&](const auto& knots) {
        for (std::size_t k = 0; k < times_.size(); ++k)
          result.push_back(predict_measurement(knots, k));
      },
      knots_);
  return result;
}

template <StateModel model>
PredictedMeasurement Trajectory::predict_measurement(const Knots<model>& knots,
                                                     std::size_t knot) const {
  constexpr int size = axis_state_size<model>;
  PredictedMeasurement point{{},
                             measurement_scale_ * measurement_scale_ * stated_variance_m2_[knot]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    point.position_m[i] =
        origin_m_[i] + units_.length_m * observe<size>(knots.smoothed[knot][axis].mean);
  }
  return point;
}

/// The measured point's motion: the body's plus its wander.
template <StateModel model>
MotionState Trajectory::to_metres(const Knots<model>& knots,
                                  const typename Knots<model>::States& states) const {
  constexpr int size = axis_state_size<model>;
  Eigen::Matrix<double, 3, size> observed = Eigen::Matrix<double, 3, size>::Zero();
  for (int order = 0; order < 3; ++order)
    observed(order, order) = units_.length_m / std::pow(units_.time_s, order);
  if constexpr (model == StateModel::with_flights) {
    observed(0, motion_size) = units_.length_m;
    observed(1, motion_size + 1) = knots.prior.wander_rate() * units_.length_m / units_.time_s;
  }
  MotionState state;
  state.covariance.setZero();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto& [mean, covariance] = states[static_cast<std::size_t>(axis)];
    const Eigen::Vector3d motion = observed * mean;
    state.position_m[axis] = origin_m_[axis] + motion[0];
    state.velocity_m_per_s[axis] = motion[1];
    state.acceleration_m_per_s2[axis] = motion[2];
    const Eigen::Matrix3d orders = observed * covariance * observed.transpose();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) state.covariance(3 * i + axis, 3 * j + axis) = orders(i, j);
  }
  return state;
}

bool Trajectory::is_finite() const {
  return std::visit(
      [&](const auto& knots) {
        return std::ranges::all_of(knots.smoothed, [](const auto& states) {
          return std::ranges::all_of(states, [](const auto& state) {
            return state.mean.allFinite() && state.covariance.allFinite() &&
                   state.covariance.diagonal().minCoeff() >= 0.0 && state.covariance(0, 0) > 0.0;
          });
        });
      },
      knots_);
}

}  // namespace touchtrace
