#include "calib/smooth/trajectory.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/smooth/scaled_track.h"

namespace touchtrace {
namespace {

double median(std::vector<double> values, double otherwise) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// P^-1 of a covariance whose diagonal spans many orders of magnitude.
template <int n>
Eigen::Matrix<double, n, n> inverse(const Eigen::Matrix<double, n, n>& p) {
  using Square = Eigen::Matrix<double, n, n>;
  const Eigen::Matrix<double, n, 1> scale =
      p.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square correlation = scale.asDiagonal() * p * scale.asDiagonal();
  const Square inverted = correlation.ldlt().solve(Square::Identity());
  return scale.asDiagonal() * inverted * scale.asDiagonal();
}

/// One step of Rauch, Tung and Striebel: `filtered` given what is known `later`.
template <int axes>
BodyState<double, axes> step_back(const BodyState<double, axes>& filtered,
                                  const Transition<double>& step,
                                  const Eigen::Matrix<double, axes, 1>& gravity,
                                  const Eigen::Matrix<double, axes, axes>& jerk,
                                  const BodyState<double, axes>& later) {
  using Body = BodyState<double, axes>;
  using Square = typename Body::Square;
  const Body predicted = filtered.after(step, gravity, jerk);
  const Square F = Body::spread(step.F);
  const Square gain = filtered.covariance * F.transpose() * inverse<3 * axes>(predicted.covariance);
  const Square keep = Square::Identity() - gain * F;
  return {filtered.mean + gain * (later.mean - predicted.mean),
          keep * filtered.covariance * keep.transpose() +
              gain * (Body::noise(step, jerk) + later.covariance) * gain.transpose()};
}

/// What a step's noise is to be expected to be, given the states before and after it, as the
/// covariance of a jerk: E[w w'] = m m' + (I - L) Q (I - L)' + L (F P F' + P+) L', L = Q (F P F' +
/// Q)^-1, m = L (x+ - F x), with its three orders whitened and averaged.
Eigen::Matrix3d jerk_of(const BodyState<double, 3>& filtered, const Transition<double>& step,
                        const Eigen::Matrix3d& jerk, const BodyState<double, 3>& later) {
  using Body = BodyState<double, 3>;
  using Square = Body::Square;
  const auto predicted = filtered.after(step, Eigen::Vector3d::Zero(), jerk);
  const Square Q = Body::noise(step, jerk), L = Q * inverse<9>(predicted.covariance),
               keep = Square::Identity() - L;
  const Body::Vector mean = L * (later.mean - predicted.mean);
  const Square square = mean * mean.transpose() + keep * Q * keep.transpose() +
                        L * (predicted.covariance - Q + later.covariance) * L.transpose();
  const Eigen::Matrix3d white = inverse<3>(step.Q);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += white(i, j) * square.block<3, 3>(3 * i, 3 * j);
  return (sum + sum.transpose()) / 6.0;
}

MotionNoise<double> scaled_by(const MotionNoise<double>& noise, double length, double time) {
  MotionNoise<double> result = noise;
  const double jerk = std::pow(time, 5) / (length * length), acceleration = time * time / length;
  result.jerk_density *= jerk;
  result.swing_rad_per_s *= time;
  result.throw_jerk_density *= jerk;
  result.flight_drag_per_s *= time;
  result.throw_s /= time;
  result.flight_jerk_density *= jerk;
  result.flight_acceleration_m_per_s2 *= acceleration;
  result.landing_velocity_m_per_s *= time / length;
  result.landing_acceleration_m_per_s2 *= acceleration;
  return result;
}

template <int axes>
constexpr Eigen::Index first_axis(std::size_t body) {
  return axes * static_cast<Eigen::Index>(body);
}

}  // namespace

MotionUnits MotionUnits::of(const std::vector<Track>& tracks) {
  std::vector<double> spacings, sigmas;
  for (const auto& track : tracks)
    for (std::size_t i = 0; i < track.size(); ++i) {
      for (double sigma : track[i].sigma_m) sigmas.push_back(sigma);
      if (i > 0 && track[i].time_s > track[i - 1].time_s)
        spacings.push_back(track[i].time_s - track[i - 1].time_s);
    }
  return {median(spacings, 1.0), median(sigmas, 1.0)};
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
  for (const auto& point : points) times_.push_back(point.time);
  if (jerk_.empty())
    run<1>(points, scaled(initial, units_));
  else
    run<3>(points, scaled(initial, units_));
}

template <int axes>
void Trajectory::run(const ScaledTrack& points, const InitialMotion& initial) {
  auto& knots = knots_.emplace<Knots<axes>>();
  const double scale = prior_.noise().measurement_scale;
  Bodies<axes> now;
  for (std::size_t body = 0; body < now.size(); ++body)
    now[body] = initial_state<axes>(points, first_axis<axes>(body), initial);
  for (std::size_t k = 0; k < points.size(); ++k) {
    now = after<axes>(now, times_[k > 0 ? k - 1 : 0], times_[k]);
    for (std::size_t body = 0; body < now.size(); ++body) {
      const auto first = first_axis<axes>(body);
      now[body].measure(points[k].position.template segment<axes>(first),
                        (scale * points[k].sigma.template segment<axes>(first)).cwiseAbs2());
    }
    knots.filtered.push_back(now);
  }
  knots.smoothed = knots.filtered;
  for (std::size_t k = times_.size() - 1; k-- > 0;)
    knots.smoothed[k] =
        before<axes>(knots.filtered[k], times_[k], times_[k + 1], knots.smoothed[k + 1]);
}

template <int axes>
Eigen::Matrix<double, axes, axes> Trajectory::jerk(double time, std::size_t body) const {
  if (jerk_.empty()) return Eigen::Matrix<double, axes, axes>::Identity();
  const auto up_to = std::lower_bound(times_.begin(), times_.end(), time) - times_.begin();
  const auto knot = std::min(static_cast<std::size_t>(up_to), jerk_.size() - 1);
  const auto first = first_axis<axes>(body);
  return jerk_[knot].block<axes, axes>(first, first);
}

template <int axes>
Trajectory::Bodies<axes> Trajectory::after(const Bodies<axes>& bodies, double from,
                                           double to) const {
  const auto step = prior_.between(from, to);
  Bodies<axes> result;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    result[body] = bodies[body].after(step, gravity_.segment<axes>(first_axis<axes>(body)),
                                      jerk<axes>(to, body));
  return result;
}

template <int axes>
Trajectory::Bodies<axes> Trajectory::before(const Bodies<axes>& filtered, double from, double to,
                                            const Bodies<axes>& later) const {
  const auto step = prior_.between(from, to);
  Bodies<axes> result;
  for (std::size_t body = 0; body < filtered.size(); ++body)
    result[body] =
        step_back<axes>(filtered[body], step, gravity_.segment<axes>(first_axis<axes>(body)),
                        jerk<axes>(to, body), later[body]);
  return result;
}

std::size_t Trajectory::knot_before(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(after - times_.begin()) - 1;
}

template <int axes>
Trajectory::Bodies<axes> Trajectory::filtered_at(const Knots<axes>& knots, double time) const {
  const auto knot = knot_before(time);
  return after<axes>(knots.filtered[knot], times_[knot], time);
}

/// x(t) = F^-1 (x0 - w)
template <int axes>
Trajectory::Bodies<axes> Trajectory::before_the_first(const Knots<axes>& knots, double time) const {
  using Body = BodyState<double, axes>;
  const auto step = prior_.touched(times_.front() - time);
  const typename Body::Square back = Body::spread(step.F.inverse());
  Bodies<axes> result = knots.smoothed.front();
  for (std::size_t body = 0; body < result.size(); ++body) {
    const auto& from = knots.smoothed.front()[body];
    result[body] = {
        back * from.mean,
        back * (from.covariance + Body::noise(step, jerk<axes>(time, body))) * back.transpose()};
  }
  return result;
}

template <int axes>
Trajectory::Bodies<axes> Trajectory::smoothed_at(const Knots<axes>& knots, double time) const {
  if (time < times_.front()) return before_the_first<axes>(knots, time);
  const auto knot = knot_before(time);
  const auto filtered = filtered_at<axes>(knots, time);
  if (knot + 1 == times_.size()) return filtered;
  return before<axes>(filtered, time, times_[knot + 1], knots.smoothed[knot + 1]);
}

MotionState Trajectory::smoothed(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  return std::visit(
      [&]<int axes>(const Knots<axes>& knots) { return in_metres<axes>(smoothed_at(knots, time)); },
      knots_);
}

MotionState Trajectory::causal(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  if (time < times_.front()) return smoothed(time_s);
  return std::visit(
      [&]<int axes>(const Knots<axes>& knots) { return in_metres<axes>(filtered_at(knots, time)); },
      knots_);
}

MotionState Trajectory::at_knot(std::size_t knot) const {
  return std::visit(
      [&]<int axes>(const Knots<axes>& knots) { return in_metres<axes>(knots.smoothed[knot]); },
      knots_);
}

std::vector<Eigen::Matrix3d> Trajectory::expected_jerk() const {
  const auto& knots = std::get<Knots<3>>(knots_);
  std::vector<Eigen::Matrix3d> result(times_.size(), Eigen::Matrix3d::Zero());
  for (std::size_t k = 1; k < times_.size(); ++k) {
    const auto step = prior_.between(times_[k - 1], times_[k]);
    if (step.Q_free.isZero(0.0) && times_[k] > times_[k - 1])
      result[k] = jerk_of(knots.filtered[k - 1][0], step, jerk_[k], knots.smoothed[k][0]);
  }
  return result;
}

template <int axes>
MotionState Trajectory::in_metres(const Bodies<axes>& bodies) const {
  const double s = units_.length_m, h = units_.time_s;
  const Eigen::Vector3d unit(s, s / h, s / (h * h));
  Eigen::Matrix3d mean;  // a column an order
  MotionState state;
  state.covariance.setZero();
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    const auto first = first_axis<axes>(body);
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
