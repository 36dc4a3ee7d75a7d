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

/// a p a'
template <int n>
Eigen::Matrix<double, n, n> conjugated(const Eigen::Matrix<double, n, n>& a,
                                       const Eigen::Matrix<double, n, n>& p) {
  return product(product(a, p), Eigen::Matrix<double, n, n>(a.transpose()));
}

/// One step of Rauch, Tung and Striebel: `filtered` given what is known `later`.
template <class Body>
Body step_back(const Body& filtered, const Transition<double>& step,
               const typename Body::Place& gravity, const typename Body::Between& jerk,
               const Body& later) {
  using Square = typename Body::Square;
  constexpr int size = Body::size;
  const Body predicted = filtered.after(step, gravity, jerk);
  const Square gain =
      product(Square(Body::template moved<size>(step, filtered.covariance).transpose()),
              inverse<size>(predicted.covariance));
  auto backwards = step;
  backwards.F.transposeInPlace();
  const Square keep =
      Square::Identity() - Body::template moved<size>(backwards, gain.transpose()).transpose();
  return {filtered.mean + gain * (later.mean - predicted.mean),
          conjugated(keep, filtered.covariance) +
              conjugated(gain, Square(Body::noise(step, jerk) + later.covariance))};
}

/// What a step's noise is to be expected to be, given the states before and after it, as the
/// covariance of a jerk: E[w w'] = m m' + (I - L) Q (I - L)' + L (F P F' + P+) L', L = Q (F P F' +
/// Q)^-1, m = L (x+ - F x), with its three orders whitened and averaged.
template <class Body>
Eigen::Matrix3d expected_jerk(const Body& filtered, const Transition<double>& step,
                              const Eigen::Matrix3d& jerk, const Body& later) {
  using Square = typename Body::Square;
  const auto predicted = filtered.after(step, Eigen::Vector3d::Zero(), jerk);
  const Square Q = Body::noise(step, jerk),
               L = product(Q, inverse<Body::size>(predicted.covariance)),
               keep = Square::Identity() - L;
  const typename Body::Vector mean = L * (later.mean - predicted.mean);
  const Square square = mean * mean.transpose() + conjugated(keep, Q) +
                        conjugated(L, Square(predicted.covariance - Q + later.covariance));
  const Eigen::Matrix3d white = inverse<3>(step.Q);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += white(i, j) * square.template block<3, 3>(3 * i, 3 * j);
  return (sum + sum.transpose()) / 6.0;
}

}  // namespace touchtrace
