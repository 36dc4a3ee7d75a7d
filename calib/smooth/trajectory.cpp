#include "calib/smooth/trajectory.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/smooth/scaled_track.h"
#include "calib/smooth/step_back.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

double median_or(std::vector<double> values, double fallback) {
  return values.empty() ? fallback : median(std::move(values));
}

MotionNoise<double> scaled_by(const MotionNoise<double>& noise, double length, double time) {
  MotionNoise<double> result = noise;
  const double jerk = std::pow(time, 5) / (length * length), acceleration = time * time / length;
  result.jerk_density *= jerk;
  result.swing_rad_per_s *= time;
  result.throw_jerk_density *= jerk;
  result.flight_drag_per_s *= time;
  result.throw_s /= time;
  result.correlation_s /= time;
  result.flight_jerk_density *= jerk;
  result.flight_acceleration_m_per_s2 *= acceleration;
  result.landing_velocity_m_per_s *= time / length;
  result.landing_acceleration_m_per_s2 *= acceleration;
  return result;
}

template <class Body>
constexpr Eigen::Index first_axis(std::size_t body) {
  return Body::axes * static_cast<Eigen::Index>(body);
}

/// Of the axes of the body that is `body`th of them.
template <class Body>
typename Body::Place of_body(const Eigen::Vector3d& values, std::size_t body) {
  return values.segment<Body::axes>(first_axis<Body>(body));
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
  Eigen::Vector3d usual_m;
  std::ranges::transform(sigmas, usual_m.begin(),
                         [](auto& of_axis) { return median_or(std::move(of_axis), 1.0); });
  const double length_m = median_or({usual_m.begin(), usual_m.end()}, 1.0);
  return {median_or(std::move(spacings), 1.0), length_m, usual_m / length_m};
}

MotionNoise<double> MotionUnits::scaled(const MotionNoise<double>& noise) const {
  return scaled_by(noise, length_m, time_s);
}

MotionNoise<double> MotionUnits::unscaled(const MotionNoise<double>& noise) const {
  return scaled_by(noise, 1.0 / length_m, 1.0 / time_s);
}

Eigen::Matrix3d MotionState::axis_covariance(Eigen::Index axis) const {
  Eigen::Matrix3d result;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j) result(i, j) = covariance(3 * i + axis, 3 * j + axis);
  return result;
}

InitialMotion scaled(const InitialMotion& initial, const MotionUnits& units) {
  return {initial.velocity_m_per_s * units.time_s / units.length_m,
          initial.acceleration_m_per_s2 / units.acceleration()};
}

Trajectory::Trajectory(const WeightedTrack& track, const MotionNoise<double>& noise,
                       const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial)
    : units_(MotionUnits::of({track.points})),
      origin_s_(track.points.front().time_s),
      origin_m_(track.points.front().position_m),
      gravity_(gravity_m_per_s2 / units_.acceleration()),
      prior_(units_.scaled(noise), contact_events(track.flights, origin_s_, units_.time_s)),
      jerk_(track.jerk) {
  const ScaledTrack points(track, units_);
  for (const auto& point : points) {
    times_.push_back(point.time);
    correlated_sigma_.push_back(point.correlated_sigma(prior_.noise()));
    own_variance_.push_back(point.own_variance(prior_.noise()));
  }
  if (noise.correlated_scale > 0.0)
    run<Errors::correlated>(points, scaled(initial, units_));
  else
    run<Errors::white>(points, scaled(initial, units_));
}

template <Errors errors>
void Trajectory::run(const ScaledTrack& points, const InitialMotion& initial) {
  if (jerk_.empty())
    run_bodies<Axis<errors>>(points, initial);
  else
    run_bodies<Whole<errors>>(points, initial);
}

template <class Body>
void Trajectory::run_bodies(const ScaledTrack& points, const InitialMotion& initial) {
  auto& knots = knots_.emplace<Knots<Body>>();
  Bodies<Body> now;
  for (std::size_t body = 0; body < now.size(); ++body)
    now[body] = initial_state<Body>(points, first_axis<Body>(body), initial);
  for (std::size_t k = 0; k < points.size(); ++k) {
    now = after<Body>(now, times_[k > 0 ? k - 1 : 0], times_[k]);
    for (std::size_t body = 0; body < now.size(); ++body)
      now[body].measure(of_body<Body>(points[k].position, body),
                        of_body<Body>(own_variance_[k] / points[k].weight, body),
                        of_body<Body>(correlated_sigma_[k], body));
    knots.filtered.push_back(now);
  }
  knots.smoothed = knots.filtered;
  for (std::size_t k = times_.size() - 1; k-- > 0;)
    knots.smoothed[k] =
        before<Body>(knots.filtered[k], times_[k], times_[k + 1], knots.smoothed[k + 1]);
}

template <class Body>
typename Body::Between Trajectory::jerk(double time, std::size_t body) const {
  if (jerk_.empty()) return Body::Between::Identity();
  const auto up_to = std::lower_bound(times_.begin(), times_.end(), time) - times_.begin();
  const auto knot = std::min(static_cast<std::size_t>(up_to), jerk_.size() - 1);
  const auto first = first_axis<Body>(body);
  return jerk_[knot].block<Body::axes, Body::axes>(first, first);
}

template <class Body>
Trajectory::Bodies<Body> Trajectory::after(const Bodies<Body>& bodies, double from,
                                           double to) const {
  const auto step = prior_.between(from, to);
  Bodies<Body> result;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    result[body] = bodies[body].after(step, of_body<Body>(gravity_, body), jerk<Body>(to, body));
  return result;
}

template <class Body>
Trajectory::Bodies<Body> Trajectory::before(const Bodies<Body>& filtered, double from, double to,
                                            const Bodies<Body>& later) const {
  const auto step = prior_.between(from, to);
  Bodies<Body> result;
  for (std::size_t body = 0; body < filtered.size(); ++body)
    result[body] = step_back<Body>(filtered[body], step, of_body<Body>(gravity_, body),
                                   jerk<Body>(to, body), later[body]);
  return result;
}

std::size_t Trajectory::knot_before(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(after - times_.begin()) - 1;
}

template <class Body>
Trajectory::Bodies<Body> Trajectory::filtered_at(const Knots<Body>& knots, double time) const {
  const auto knot = knot_before(time);
  return after<Body>(knots.filtered[knot], times_[knot], time);
}

/// x(t) = F^-1 (x0 - w)
template <class Body>
Trajectory::Bodies<Body> Trajectory::before_the_first(const Knots<Body>& knots, double time) const {
  const auto step = prior_.touched(times_.front() - time);
  auto backwards = step;
  backwards.F = step.F.inverse().eval();
  Bodies<Body> result = knots.smoothed.front();
  for (std::size_t body = 0; body < result.size(); ++body) {
    const auto& [mean, covariance] = knots.smoothed.front()[body];
    result[body] = {
        Body::template moved<1>(backwards, mean),
        Body::moved_covariance(backwards, covariance + Body::noise(step, jerk<Body>(time, body)))};
  }
  return result;
}

template <class Body>
Trajectory::Bodies<Body> Trajectory::smoothed_at(const Knots<Body>& knots, double time) const {
  if (time < times_.front()) return before_the_first<Body>(knots, time);
  const auto knot = knot_before(time);
  const auto filtered = filtered_at<Body>(knots, time);
  if (knot + 1 == times_.size()) return filtered;
  return before<Body>(filtered, time, times_[knot + 1], knots.smoothed[knot + 1]);
}

MotionState Trajectory::smoothed(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  return std::visit(
      [&]<class Body>(const Knots<Body>& knots) {
        return in_metres<Body>(smoothed_at(knots, time));
      },
      knots_);
}

MotionState Trajectory::causal(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  if (time < times_.front()) return smoothed(time_s);
  return std::visit(
      [&]<class Body>(const Knots<Body>& knots) {
        return in_metres<Body>(filtered_at(knots, time));
      },
      knots_);
}

std::vector<ForetoldPoint> Trajectory::foretold() const {
  std::vector<ForetoldPoint> result;
  std::visit(
      [&]<class Body>(const Knots<Body>& knots) {
        for (std::size_t k = 0; k < times_.size(); ++k)
          result.push_back(foretold<Body>(knots.smoothed[k], k));
      },
      knots_);
  return result;
}

template <class Body>
ForetoldPoint Trajectory::foretold(const Bodies<Body>& bodies, std::size_t knot) const {
  constexpr int axes = Body::axes;
  ForetoldPoint point;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    const auto first = first_axis<Body>(body);
    const auto sigma = of_body<Body>(correlated_sigma_[knot], body);
    const auto& [mean, covariance] = bodies[body];
    point.position_m.segment<axes>(first) = Body::template measured<1>(mean, sigma);
    point.variance_m2.segment<axes>(first) =
        Body::template measured<axes>(
            Body::template measured<Body::size>(covariance, sigma).transpose(), sigma)
            .diagonal();
  }
  const double length_m = units_.length_m, length_m2 = length_m * length_m;
  return {origin_m_ + length_m * point.position_m, length_m2 * point.variance_m2,
          length_m2 * own_variance_[knot]};
}

std::vector<Eigen::Matrix3d> Trajectory::expected_jerk() const {
  std::vector<Eigen::Matrix3d> result(times_.size(), Eigen::Matrix3d::Zero());
  std::visit(
      [&]<class Body>(const Knots<Body>& knots) {
        if constexpr (Body::axes == 3)
          for (std::size_t k = 1; k < times_.size(); ++k) {
            const auto step = prior_.between(times_[k - 1], times_[k]);
            if (step.Q_free.isZero(0.0) && times_[k] > times_[k - 1])
              result[k] = touchtrace::expected_jerk(knots.filtered[k - 1][0], step, jerk_[k],
                                                    knots.smoothed[k][0]);
          }
      },
      knots_);
  return result;
}

template <class Body>
MotionState Trajectory::in_metres(const Bodies<Body>& bodies) const {
  constexpr int axes = Body::axes;
  const double s = units_.length_m, h = units_.time_s;
  const Eigen::Vector3d unit(s, s / h, s / (h * h));
  Eigen::Matrix3d mean;  // a column an order
  MotionState state;
  state.covariance.setZero();
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    const auto first = first_axis<Body>(body);
    for (int i = 0; i < 3; ++i) {
      mean.block<axes, 1>(first, i) = unit[i] * bodies[body].mean.template segment<axes>(axes * i);
      for (int j = 0; j < 3; ++j)
        state.covariance.block<axes, axes>(3 * i + first, 3 * j + first) =
            unit[i] * unit[j] *
            bodies[body].covariance.template block<axes, axes>(axes * i, axes * j);
    }
  }
  state.position_m = origin_m_ + mean.col(0);
  state.velocity_m_per_s = mean.col(1);
  state.acceleration_m_per_s2 = mean.col(2);
  return state;
}

bool Trajectory::finite() const {
  const auto is_finite = [](const auto& body) {
    return body.mean.allFinite() && body.covariance.allFinite() &&
           body.covariance.diagonal().minCoeff() > 0.0;
  };
  return std::visit(
      [&](const auto& knots) {
        return std::ranges::all_of(knots.smoothed, [&](const auto& bodies) {
          return std::ranges::all_of(bodies, is_finite);
        });
      },
      knots_);
}

}  // namespace touchtrace
