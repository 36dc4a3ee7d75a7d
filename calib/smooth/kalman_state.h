#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {

/// a b, column by column: Eigen's own product of these sizes is tuned for large matrices and takes
/// twice as long.
template <int n, int m>
Eigen::Matrix<double, n, m> product(const Eigen::Matrix<double, n, n>& a,
                                    const Eigen::Matrix<double, n, m>& b) {
  Eigen::Matrix<double, n, m> result;
  for (int j = 0; j < m; ++j) {
    Eigen::Matrix<double, n, 1> sum = a.col(0) * b(0, j);
    for (int k = 1; k < n; ++k) sum += a.col(k) * b(k, j);
    result.col(j) = sum;
  }
  return result;
}

/// a p a'
template <int n>
Eigen::Matrix<double, n, n> conjugated(const Eigen::Matrix<double, n, n>& a,
                                       const Eigen::Matrix<double, n, n>& p) {
  return product(product(a, p), Eigen::Matrix<double, n, n>(a.transpose()));
}

/// Row h of the measurement y = h x: the position plus, with 5 states, the wander.
template <int size>
double observe(const Eigen::Matrix<double, size, 1>& x) {
  if constexpr (size > motion_size) return x[0] + x[motion_size];
  return x[0];
}

/// p h' for a covariance, or any other matrix, p.
template <int size>
Eigen::Matrix<double, size, 1> observe_columns(const Eigen::Matrix<double, size, size>& p) {
  if constexpr (size > motion_size) return p.col(0) + p.col(motion_size);
  return p.col(0);
}

/// Innovation of a measurement: its value and variance, and the gain.
template <int size>
struct Innovation {
  double value, variance;
  Eigen::Matrix<double, size, 1> gain;

  /// Negative log-likelihood without its constant.
  double cost() const { return 0.5 * (value * value / variance + std::log(variance)); }
};

/// Kalman filter state of one axis.
template <int size>
struct AxisState {
  using Vector = Eigen::Matrix<double, size, 1>;
  using Square = Eigen::Matrix<double, size, size>;

  Vector mean = Vector::Zero();
  Square covariance = Square::Zero();

  /// Prediction step. `scale`: factor of the process noise Q.
  AxisState predict(const Transition<size>& step, double gravity, double scale) const {
    return {step.F * mean + step.u * gravity,
            conjugated(step.F, covariance) + scale * step.Q + step.Q_fixed};
  }

  /// Update step in Joseph form.
  Innovation<size> update(double position, double variance) {
    const Vector cross = observe_columns<size>(covariance);
    Innovation<size> innovation{
        position - observe<size>(mean), observe<size>(cross) + variance, {}};
    innovation.gain = cross / innovation.variance;
    mean += innovation.gain * innovation.value;
    const Vector& gain = innovation.gain;
    const Square once = covariance - gain * cross.transpose();
    const Vector column = observe_columns<size>(once);
    for (int i = 0; i < size; ++i)  // by element: Eigen takes twice as long
      for (int j = 0; j <= i; ++j)
        covariance(i, j) = covariance(j, i) =
            0.5 * (once(i, j) - column[i] * gain[j] + once(j, i) - column[j] * gain[i]) +
            variance * gain[i] * gain[j];
    return innovation;
  }
};

/// Inverse of a covariance whose diagonal spans many orders of magnitude: scaled to a correlation
/// matrix first. Rows and columns of zero variance stay zero.
template <int n>
Eigen::Matrix<double, n, n> inverse(const Eigen::Matrix<double, n, n>& p) {
  using Square = Eigen::Matrix<double, n, n>;
  const Eigen::Matrix<double, n, 1> scale =
      p.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square correlation = scale.asDiagonal() * p * scale.asDiagonal();
  const Square inverted = correlation.ldlt().solve(Square::Identity());
  return scale.asDiagonal() * inverted * scale.asDiagonal();
}

/// Rauch-Tung-Striebel step: the smoothed state at `filtered`'s time, given the smoothed state
/// `later` after `step`. The covariance is a sum of positive semidefinite terms.
template <int size>
AxisState<size> rts_step(const AxisState<size>& filtered, const Transition<size>& step,
                         double gravity, double scale, const AxisState<size>& later) {
  using Square = typename AxisState<size>::Square;
  const auto predicted = filtered.predict(step, gravity, scale);
  const Square gain = product(Square(product(step.F, filtered.covariance).transpose()),
                              inverse<size>(predicted.covariance));
  const Square factor = Square::Identity() - product(gain, step.F);
  return {filtered.mean + gain * (later.mean - predicted.mean),
          conjugated(factor, filtered.covariance) +
              conjugated(gain, Square(scale * step.Q + step.Q_fixed + later.covariance))};
}

}  // namespace touchtrace
