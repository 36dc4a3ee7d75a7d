#pragma once

#include <Eigen/Cholesky>

#include "calib/smooth/kalman_state.h"

namespace touchtrace {

/// Inverse of a covariance whose diagonal spans many orders of magnitude: scaled to a correlation
/// matrix first.
template <int n>
Eigen::Matrix<double, n, n> inverse(const Eigen::Matrix<double, n, n>& p) {
  using Square = Eigen::Matrix<double, n, n>;
  const Eigen::Matrix<double, n, 1> scale =
      p.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square correlation = scale.asDiagonal() * p * scale.asDiagonal();
  const Square inverted = correlation.ldlt().solve(Square::Identity());
  return scale.asDiagonal() * inverted * scale.asDiagonal();
}

/// a p a'
template <int n>
Eigen::Matrix<double, n, n> conjugated(const Eigen::Matrix<double, n, n>& a,
                                       const Eigen::Matrix<double, n, n>& p) {
  return product(product(a, p), Eigen::Matrix<double, n, n>(a.transpose()));
}

/// Rauch-Tung-Striebel step: the smoothed state at `filtered`'s time, given the smoothed state
/// `later` after `step`.
template <class State>
State rts_step(const State& filtered, const Transition<double>& step,
               const typename State::AxisVector& gravity,
               const typename State::AxisMatrix& jerk_covariance, const State& later) {
  using Square = typename State::Square;
  constexpr int size = State::size;
  const State predicted = filtered.predict(step, gravity, jerk_covariance);
  const Square gain =
      product(Square(State::template propagate<size>(step, filtered.covariance).transpose()),
              inverse<size>(predicted.covariance));
  auto transposed = step;
  transposed.F.transposeInPlace();
  const Square factor = Square::Identity() -
                        State::template propagate<size>(transposed, gain.transpose()).transpose();
  return {
      filtered.mean + gain * (later.mean - predicted.mean),
      conjugated(factor, filtered.covariance) +
          conjugated(gain, Square(State::process_noise(step, jerk_covariance) + later.covariance))};
}

/// Expected covariance of the jerk in a step, given the filtered state before and the smoothed
/// state after it, relative to the noise's density (the E step of time-varying process noise):
///     E[w w'] = m m' + (I - L) Q (I - L)' + L (F P F' + P+) L',
///     L = Q (F P F' + Q)^-1,  m = L (x+ - F x),
/// whitened by Q and averaged over position, velocity and acceleration.
template <class State>
Eigen::Matrix3d expected_jerk_covariance(const State& filtered, const Transition<double>& step,
                                         const Eigen::Matrix3d& jerk_covariance,
                                         const State& later) {
  using Square = typename State::Square;
  const auto predicted = filtered.predict(step, Eigen::Vector3d::Zero(), jerk_covariance);
  const Square Q = State::process_noise(step, jerk_covariance),
               L = product(Q, inverse<State::size>(predicted.covariance)),
               factor = Square::Identity() - L;
  const typename State::Vector mean = L * (later.mean - predicted.mean);
  const Square square = mean * mean.transpose() + conjugated(factor, Q) +
                        conjugated(L, Square(predicted.covariance - Q + later.covariance));
  const Eigen::Matrix3d white = inverse<3>(step.Q);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += white(i, j) * square.template block<3, 3>(3 * i, 3 * j);
  return (sum + sum.transpose()) / 6.0;
}

}  // namespace touchtrace
