#include "calib/smooth/trajectory.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/smooth/rts_step.h"
#include "calib/smooth/scaled_track.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

double median_or(std::vector<double> values, double otherwise) {
  return values.empty() ? otherwise : median(std::move(values));
}

MotionNoise<double> in_units(const MotionNoise<double>& noise, double length, double time) {
  MotionNoise<double> result = noise;
  const double jerk = std::pow(time, 5) / (length * length), acceleration = time * time / length;
  result.jerk_density *= jerk;
  result.oscillator_rad_per_s *= time;
  result.throw_jerk_density *= jerk;
  result.flight_drag_per_s *= time;
  result.throw_duration_s /= time;
  result.correlation_time_s /= time;
  result.flight_jerk_density *= jerk;
  result.flight_acceleration_sigma_m_per_s2 *= acceleration;
  result.landing_velocity_sigma_m_per_s *= time / length;
  result.landing_acceleration_sigma_m_per_s2 *= acceleration;
  return result;
}

/// First axis of a group of axes: a group is one element of Trajectory::States.
template <class State>
constexpr Eigen::Index first_axis(std::size_t group) {
  return State::axes * static_cast<Eigen::Index>(group);
}

/// Values of the group's axes.
template <class State>
typename State::AxisVector axes_of(const Eigen::Vector3d& values, std::size_t group) {
  return values.segment<State::axes>(first_axis<State>(group));
}

}  // namespace

MotionUnits MotionUnits::of(const std::vector<Track>& tracks) {
  std::vector<double> spacings;
  std::array<std::vector<double>, 3> sigmas;
  for (const auto& track : tracks)
    for (std::size_t i = 0; i < track.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        sigmas[axis].push_back(track[i].sigma_m[static_cast<Eigen::Index>(axis)]);
      if (i > 0 && track[i].time_s > track[i - 1].time_s)
        spacings.push_back(track[i].time_s - track[i - 1].time_s);
    }
  Eigen::Vector3d median_m;
  std::ranges::transform(sigmas, median_m.begin(),
                         [](auto& of_axis) { return median_or(std::move(of_axis), 1.0); });
  const double length_m = median_or({median_m.begin(), median_m.end()}, 1.0);
  return {median_or(std::move(spacings), 1.0), length_m, median_m / length_m};
}

MotionNoise<double> MotionUnits::scaled(const MotionNoise<double>& noise) const {
  return in_units(noise, length_m, time_s);
}

MotionNoise<double> MotionUnits::unscaled(const MotionNoise<double>& noise) const {
  return in_units(noise, 1.0 / length_m, 1.0 / time_s);
}

InitialMotion scaled(const InitialMotion& initial, const MotionUnits& units) {
  return {initial.velocity_sigma_m_per_s * units.time_s / units.length_m,
          initial.acceleration_sigma_m_per_s2 / units.acceleration()};
}

Trajectory::Trajectory(const WeightedTrack& track, const MotionNoise<double>& noise,
                       const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial)
    : units_(MotionUnits::of({track.points})),
      origin_s_(track.points.front().time_s),
      origin_m_(track.points.front().position_m),
      gravity_(gravity_m_per_s2 / units_.acceleration()),
      prior_(units_.scaled(noise), contact_events(track.flights, origin_s_, units_.time_s)),
      jerk_covariance_(track.jerk_covariance) {
  const ScaledTrack points(track, units_);
  for (const auto& point : points) {
    times_.push_back(point.time);
    correlated_sigma_.push_back(point.correlated_sigma(prior_.noise()));
    white_variance_.push_back(point.white_variance(prior_.noise()));
  }
  if (noise.correlated_scale > 0.0)
    solve<ErrorModel::correlated>(points, scaled(initial, units_));
  else
    solve<ErrorModel::white>(points, scaled(initial, units_));
}

template <ErrorModel errors>
void Trajectory::solve(const ScaledTrack& points, const InitialMotion& initial) {
  if (jerk_covariance_.empty())
    solve_states<IndependentAxis<errors>>(points, initial);
  else
    solve_states<CoupledAxes<errors>>(points, initial);
}

template <class State>
void Trajectory::solve_states(const ScaledTrack& points, const InitialMotion& initial) {
  auto& knots = knots_.emplace<Knots<State>>();
  States<State> now;
  for (std::size_t group = 0; group < now.size(); ++group)
    now[group] = initial_state<State>(points, first_axis<State>(group), initial);
  for (std::size_t k = 0; k < points.size(); ++k) {
    now = predict<State>(now, times_[k > 0 ? k - 1 : 0], times_[k]);
    for (std::size_t group = 0; group < now.size(); ++group)
      now[group].update(axes_of<State>(points[k].position, group),
                        axes_of<State>(white_variance_[k] / points[k].weight, group),
                        axes_of<State>(correlated_sigma_[k], group));
    knots.filtered.push_back(now);
  }
  knots.smoothed = knots.filtered;
  for (std::size_t k = times_.size() - 1; k-- > 0;)
    knots.smoothed[k] =
        smooth_step<State>(knots.filtered[k], times_[k], times_[k + 1], knots.smoothed[k + 1]);
}

template <class State>
typename State::AxisMatrix Trajectory::jerk_covariance_at(double time, std::size_t group) const {
  if (jerk_covariance_.empty()) return State::AxisMatrix::Identity();
  const auto next = std::lower_bound(times_.begin(), times_.end(), time) - times_.begin();
  const auto knot = std::min(static_cast<std::size_t>(next), jerk_covariance_.size() - 1);
  const auto first = first_axis<State>(group);
  return jerk_covariance_[knot].block<State::axes, State::axes>(first, first);
}

template <class State>
Trajectory::States<State> Trajectory::predict(const States<State>& states, double from,
                                              double to) const {
  const auto step = prior_.between(from, to);
  States<State> result;
  for (std::size_t group = 0; group < states.size(); ++group)
    result[group] = states[group].predict(step, axes_of<State>(gravity_, group),
                                          jerk_covariance_at<State>(to, group));
  return result;
}

template <class State>
Trajectory::States<State> Trajectory::smooth_step(const States<State>& filtered, double from,
                                                  double to, const States<State>& later) const {
  const auto step = prior_.between(from, to);
  States<State> result;
  for (std::size_t group = 0; group < filtered.size(); ++group)
    result[group] = rts_step<State>(filtered[group], step, axes_of<State>(gravity_, group),
                                    jerk_covariance_at<State>(to, group), later[group]);
  return result;
}

std::size_t Trajectory::knot_before(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(after - times_.begin()) - 1;
}

template <class State>
Trajectory::States<State> Trajectory::filtered_at(const Knots<State>& knots, double time) const {
  const auto knot = knot_before(time);
  return predict<State>(knots.filtered[knot], times_[knot], time);
}

/// x(t) = F^-1 (x0 - w), in contact
template <class State>
Trajectory::States<State> Trajectory::extrapolate_backwards(const Knots<State>& knots,
                                                            double time) const {
  const auto step = prior_.in_contact(times_.front() - time);
  auto backwards = step;
  backwards.F = step.F.inverse().eval();
  States<State> result = knots.smoothed.front();
  for (std::size_t group = 0; group < result.size(); ++group) {
    const auto& [mean, covariance] = knots.smoothed.front()[group];
    result[group] = {
        State::template propagate<1>(backwards, mean),
        State::propagate_covariance(
            backwards,
            covariance + State::process_noise(step, jerk_covariance_at<State>(time, group)))};
  }
  return result;
}

template <class State>
Trajectory::States<State> Trajectory::smoothed_at(const Knots<State>& knots, double time) const {
  if (time < times_.front()) return extrapolate_backwards<State>(knots, time);
  const auto knot = knot_before(time);
  const auto filtered = filtered_at<State>(knots, time);
  if (knot + 1 == times_.size()) return filtered;
  return smooth_step<State>(filtered, time, times_[knot + 1], knots.smoothed[knot + 1]);
}

MotionState Trajectory::smoothed(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  return std::visit(
      [&]<class State>(const Knots<State>& knots) {
        return to_metres<State>(smoothed_at(knots, time));
      },
      knots_);
}

MotionState Trajectory::causal(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  if (time < times_.front()) return smoothed(time_s);
  return std::visit(
      [&]<class State>(const Knots<State>& knots) {
        return to_metres<State>(filtered_at(knots, time));
      },
      knots_);
}

std::vector<PredictedMeasurement> Trajectory::predicted_measurements() const {
  std::vector<PredictedMeasurement> result;
  std::visit(
      [&]<class State>(const Knots<State>& knots) {
        for (std::size_t k = 0; k < times_.size(); ++k)
          result.push_back(predict_measurement<State>(knots.smoothed[k], k));
      },
      knots_);
  return result;
}

template <class State>
PredictedMeasurement Trajectory::predict_measurement(const States<State>& states,
                                                     std::size_t knot) const {
  constexpr int axes = State::axes;
  PredictedMeasurement point;
  for (std::size_t group = 0; group < states.size(); ++group) {
    const auto first = first_axis<State>(group);
    const auto sigma = axes_of<State>(correlated_sigma_[knot], group);
    const auto& [mean, covariance] = states[group];
    point.position_m.segment<axes>(first) = State::template observe<1>(mean, sigma);
    point.variance_m2.segment<axes>(first) =
        State::template observe<axes>(
            State::template observe<State::size>(covariance, sigma).transpose(), sigma)
            .diagonal();
  }
  const double length_m = units_.length_m, length_m2 = length_m * length_m;
  return {origin_m_ + length_m * point.position_m, length_m2 * point.variance_m2,
          length_m2 * white_variance_[knot]};
}

std::vector<Eigen::Matrix3d> Trajectory::expected_jerk_covariances() const {
  std::vector<Eigen::Matrix3d> result(times_.size(), Eigen::Matrix3d::Zero());
  std::visit(
      [&]<class State>(const Knots<State>& knots) {
        if constexpr (State::axes == 3)
          for (std::size_t k = 1; k < times_.size(); ++k) {
            const auto step = prior_.between(times_[k - 1], times_[k]);
            if (step.Q_fixed.isZero(0.0) && times_[k] > times_[k - 1])
              result[k] = expected_jerk_covariance(knots.filtered[k - 1][0], step,
                                                   jerk_covariance_[k], knots.smoothed[k][0]);
          }
      },
      knots_);
  return result;
}

template <class State>
MotionState Trajectory::to_metres(const States<State>& states) const {
  constexpr int axes = State::axes;
  const double s = units_.length_m, h = units_.time_s;
  const Eigen::Vector3d unit(s, s / h, s / (h * h));
  Eigen::Matrix3d mean;  // one column per order
  MotionState state;
  state.covariance.setZero();
  for (std::size_t group = 0; group < states.size(); ++group) {
    const auto first = first_axis<State>(group);
    for (int i = 0; i < 3; ++i) {
      mean.block<axes, 1>(first, i) = unit[i] * states[group].mean.template segment<axes>(axes * i);
      for (int j = 0; j < 3; ++j)
        state.covariance.block<axes, axes>(3 * i + first, 3 * j + first) =
            unit[i] * unit[j] *
            states[group].covariance.template block<axes, axes>(axes * i, axes * j);
    }
  }
  state.position_m = origin_m_ + mean.col(0);
  state.velocity_m_per_s = mean.col(1);
  state.acceleration_m_per_s2 = mean.col(2);
  return state;
}

bool Trajectory::is_finite() const {
  const auto is_valid = [](const auto& state) {
    return state.mean.allFinite() && state.covariance.allFinite() &&
           state.covariance.diagonal().minCoeff() > 0.0;
  };
  return std::visit(
      [&](const auto& knots) {
        return std::ranges::all_of(knots.smoothed, [&](const auto& states) {
          return std::ranges::all_of(states, is_valid);
        });
      },
      knots_);
}

}  // namespace touchtrace
