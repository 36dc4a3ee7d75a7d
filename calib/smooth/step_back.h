#pragma once

#include <Eigen/Cholesky>

#include "calib/smooth/body_state.h"

namespace touchtrace {

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
template <class Body>
Body step_back(const Body& filtered, const Transition<double>& step,
               const typename Body::Place& gravity, const typename Body::Between& jerk,
               const Body& later) {
  using Square = typename Body::Square;
  const Body predicted = filtered.after(step, gravity, jerk);
  const Square F = Body::transition(step);
  const Square gain =
      filtered.covariance * F.transpose() * inverse<Body::size>(predicted.covariance);
  const Square keep = Square::Identity() - gain * F;
  return {filtered.mean + gain * (later.mean - predicted.mean),
          keep * filtered.covariance * keep.transpose() +
              gain * (Body::noise(step, jerk) + later.covariance) * gain.transpose()};
}

/// What a step's noise is to be expected to be, given the states before and after it, as the
/// covariance of a jerk: E[w w'] = m m' + (I - L) Q (I - L)' + L (F P F' + P+) L', L = Q (F P F' +
/// Q)^-1, m = L (x+ - F x), with its three orders whitened and averaged.
template <class Body>
Eigen::Matrix3d expected_jerk(const Body& filtered, const Transition<double>& step,
                              const Eigen::Matrix3d& jerk, const Body& later) {
  using Square = typename Body::Square;
  const auto predicted = filtered.after(step, Eigen::Vector3d::Zero(), jerk);
  const Square Q = Body::noise(step, jerk), L = Q * inverse<Body::size>(predicted.covariance),
               keep = Square::Identity() - L;
  const typename Body::Vector mean = L * (later.mean - predicted.mean);
  const Square square = mean * mean.transpose() + keep * Q * keep.transpose() +
                        L * (predicted.covariance - Q + later.covariance) * L.transpose();
  const Eigen::Matrix3d white = inverse<3>(step.Q);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += white(i, j) * square.template block<3, 3>(3 * i, 3 * j);
  return (sum + sum.transpose()) / 6.0;
}

}  // namespace touchtrace
