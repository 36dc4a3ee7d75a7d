#include "calib/smooth/trajectory.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/smooth/scaled_track.h"

namespace touchtrace {
namespace {

constexpr std::size_t axes = 3;

double median(std::vector<double> values, double otherwise) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// P^-1 of a covariance whose diagonal spans many orders of magnitude.
Eigen::Matrix3d inverse(const Eigen::Matrix3d& p) {
  const Eigen::Vector3d scale = p.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation = scale.asDiagonal() * p * scale.asDiagonal();
  const Eigen::Matrix3d inverted = correlation.ldlt().solve(Eigen::Matrix3d::Identity());
  return scale.asDiagonal() * inverted * scale.asDiagonal();
}

/// One step of Rauch, Tung and Striebel: `filtered` given what is known `later`.
AxisState<double> step_back(const AxisState<double>& filtered, const Transition<double>& step,
                            double gravity, const AxisState<double>& later) {
  const auto predicted = filtered.after(step, gravity);
  const Eigen::Matrix3d gain =
      filtered.covariance * step.F.transpose() * inverse(predicted.covariance);
  const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain * step.F;
  return {filtered.mean + gain * (later.mean - predicted.mean),
          keep * filtered.covariance * keep.transpose() +
              gain * (step.Q + later.covariance) * gain.transpose()};
}

MotionNoise<double> scaled_by(const MotionNoise<double>& noise, double length, double time) {
  MotionNoise<double> result = noise;
  const double jerk = std::pow(time, 5) / (length * length), acceleration = time * time / length;
  result.jerk_density *= jerk;
  result.swing_rad_per_s *= time;
  result.flight_jerk_density *= jerk;
  result.flight_acceleration_m_per_s2 *= acceleration;
  result.landing_velocity_m_per_s *= time / length;
  result.landing_acceleration_m_per_s2 *= acceleration;
  return result;
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

Eigen::Matrix<double, 6, 6> MotionState::position_velocity_covariance() const {
  Eigen::Matrix<double, 6, 6> result = Eigen::Matrix<double, 6, 6>::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        result(axis + 3 * i, axis + 3 * j) = covariance[static_cast<std::size_t>(axis)](i, j);
  return result;
}

InitialMotion scaled(const InitialMotion& initial, const MotionUnits& units) {
  return {initial.velocity_m_per_s * units.time_s / units.length_m,
          initial.acceleration_m_per_s2 / units.acceleration()};
}

AxisState<double> initial_state(const ScaledTrack& track, std::size_t axis,
                                const InitialMotion& initial) {
  constexpr double wide = 1e3;  // in deviations of a measurement; more is lost to rounding
  const double spread = std::max(wide * track.front().sigma[axis], track.extent);
  AxisState<double> state;
  state.mean[0] = track.front().position[axis];
  state.covariance.diagonal() << spread * spread,
      std::pow(std::min(spread, initial.velocity_m_per_s), 2),
      std::pow(std::min(spread, initial.acceleration_m_per_s2), 2);
  return state;
}

Trajectory::Trajectory(const Track& track, const std::vector<double>& weights,
                       const std::vector<Flight>& flights, const MotionNoise<double>& noise,
                       const Eigen::Vector3d& gravity_m_per_s2, const InitialMotion& initial)
    : units_(MotionUnits::of({track})),
      origin_s_(track.front().time_s),
      origin_m_(track.front().position_m),
      gravity_(gravity_m_per_s2 / units_.acceleration()),
      prior_(units_.scaled(noise), contact_events(flights, origin_s_, units_.time_s)) {
  run_filter(track, weights, initial);
  run_smoother();
}

void Trajectory::run_filter(const Track& track, const std::vector<double>& weights,
                            const InitialMotion& initial) {
  const ScaledTrack points(track, weights, units_);
  const double scale = prior_.noise().measurement_scale;
  Axes now;
  for (std::size_t axis = 0; axis < axes; ++axis)
    now[axis] = initial_state(points, axis, scaled(initial, units_));
  double time = 0.0;
  for (const auto& point : points) {
    const auto step = prior_.between(time, point.time);
    for (std::size_t axis = 0; axis < axes; ++axis) {
      now[axis] = now[axis].after(step, gravity_[static_cast<Eigen::Index>(axis)]);
      now[axis].measure(point.position[axis], std::pow(scale * point.sigma[axis], 2));
    }
    times_.push_back(time = point.time);
    filtered_.push_back(now);
  }
}

void Trajectory::run_smoother() {
  smoothed_ = filtered_;
  for (std::size_t k = times_.size() - 1; k-- > 0;) {
    const auto step = prior_.between(times_[k], times_[k + 1]);
    for (std::size_t axis = 0; axis < axes; ++axis)
      smoothed_[k][axis] =
          step_back(filtered_[k][axis], step, gravity_[static_cast<Eigen::Index>(axis)],
                    smoothed_[k + 1][axis]);
  }
}

std::size_t Trajectory::knot_before(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(after - times_.begin()) - 1;
}

Trajectory::Axes Trajectory::filtered_at(std::size_t knot, double time) const {
  const auto step = prior_.between(times_[knot], time);
  Axes result = filtered_[knot];
  for (std::size_t axis = 0; axis < axes; ++axis)
    result[axis] = result[axis].after(step, gravity_[static_cast<Eigen::Index>(axis)]);
  return result;
}

Trajectory::Axes Trajectory::smoothed_at(double time) const {
  if (time < times_.front()) {  // x(t) = F^-1 (x0 - w)
    const double h = times_.front() - time;
    const auto step = prior_.touched(h);
    const Eigen::Matrix3d back = step.F.inverse();
    Axes result = smoothed_.front();
    for (auto& axis : result)
      axis = {back * axis.mean, back * (axis.covariance + step.Q) * back.transpose()};
    return result;
  }
  const auto knot = knot_before(time);
  Axes result = filtered_at(knot, time);
  if (knot + 1 == times_.size()) return result;
  const auto step = prior_.between(time, times_[knot + 1]);
  for (std::size_t axis = 0; axis < axes; ++axis)
    result[axis] = step_back(result[axis], step, gravity_[static_cast<Eigen::Index>(axis)],
                             smoothed_[knot + 1][axis]);
  return result;
}

MotionState Trajectory::smoothed(double time_s) const {
  return in_metres(smoothed_at((time_s - origin_s_) / units_.time_s));
}

MotionState Trajectory::causal(double time_s) const {
  const double time = (time_s - origin_s_) / units_.time_s;
  return in_metres(time < times_.front() ? smoothed_at(time)
                                         : filtered_at(knot_before(time), time));
}

MotionState Trajectory::in_metres(const Axes& scaled) const {
  const double s = units_.length_m, h = units_.time_s;
  const Eigen::Vector3d unit(s, s / h, s / (h * h));
  MotionState state;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const Eigen::Vector3d mean = unit.asDiagonal() * scaled[axis].mean;
    state.position_m[i] = origin_m_[i] + mean[0];
    state.velocity_m_per_s[i] = mean[1];
    state.acceleration_m_per_s2[i] = mean[2];
    state.covariance[axis] = unit.asDiagonal() * scaled[axis].covariance * unit.asDiagonal();
  }
  return state;
}

bool Trajectory::finite() const {
  return std::ranges::all_of(smoothed_, [](const Axes& knot) {
    return std::ranges::all_of(knot, [](const AxisState<double>& axis) {
      return axis.mean.allFinite() && axis.covariance.allFinite() &&
             axis.covariance.diagonal().minCoeff() > 0.0;
    });
  });
}

}  // namespace touchtrace
