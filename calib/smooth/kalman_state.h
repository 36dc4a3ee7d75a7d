#pragma once

#include <Eigen/Cholesky>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {

/// Kronecker product [3 axes, 3 axes] of a matrix between (position, velocity, acceleration) and
/// one between axes.
template <class T, int axes>
Eigen::Matrix<T, 3 * axes, 3 * axes> kronecker(const Matrix3<T>& orders,
                                               const Eigen::Matrix<T, axes, axes>& between_axes) {
  if constexpr (axes == 1) return orders * between_axes(0, 0);
  Eigen::Matrix<T, 3 * axes, 3 * axes> product;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      product.template block<axes, axes>(axes * i, axes * j) = orders(i, j) * between_axes;
  return product;
}

/// a b, column by column: Eigen's own product of these sizes is tuned for large matrices and takes
/// twice as long.
template <class T, int n, int m>
Eigen::Matrix<T, n, m> product(const Eigen::Matrix<T, n, n>& a, const Eigen::Matrix<T, n, m>& b) {
  Eigen::Matrix<T, n, m> result;
  for (int j = 0; j < m; ++j) {
    Eigen::Matrix<T, n, 1> sum = a.col(0) * b(0, j);
    for (int k = 1; k < n; ++k) sum += a.col(k) * b(k, j);
    result.col(j) = sum;
  }
  return result;
}

/// Measurement errors: independent, or with a first-order autoregressive part.
enum class ErrorModel { white, correlated };

/// Kalman filter state of `axes` coupled axes: positions, velocities, accelerations and, with
/// correlated errors, the correlated error in units of its standard deviation. Covariances are
/// computed as sums of positive semidefinite terms, never as differences.
template <class T, int axes_, ErrorModel errors = ErrorModel::white>
struct KalmanState {
  static constexpr int axes = axes_, motion_size = 3 * axes;
  static constexpr bool has_correlated_errors = errors == ErrorModel::correlated;
  static constexpr int size = has_correlated_errors ? motion_size + axes : motion_size;
  using AxisVector = Eigen::Matrix<T, axes, 1>;
  using AxisMatrix = Eigen::Matrix<T, axes, axes>;
  using Vector = Eigen::Matrix<T, size, 1>;
  using Square = Eigen::Matrix<T, size, size>;

  Vector mean = Vector::Zero();
  Square covariance = Square::Zero();

  /// F x for x [size, n]; F is the same for every axis.
  template <int n>
  static Eigen::Matrix<T, size, n> propagate(const Transition<T>& step,
                                             const Eigen::Matrix<T, size, n>& x) {
    Eigen::Matrix<T, size, n> result;
    for (int i = 0; i < 3; ++i)
      result.template middleRows<axes>(axes * i) =
          step.F(i, 0) * x.template topRows<axes>() +
          step.F(i, 1) * x.template middleRows<axes>(axes) +
          step.F(i, 2) * x.template middleRows<axes>(2 * axes);
    if constexpr (has_correlated_errors)
      result.template bottomRows<axes>() = step.error_decay * x.template bottomRows<axes>();
    return result;
  }

  /// F p F'
  static Square propagate_covariance(const Transition<T>& step, const Square& p) {
    const Square once = propagate<size>(step, p);
    return propagate<size>(step, once.transpose());
  }

  /// Process noise of a step. `jerk_covariance`: see Transition.
  static Square process_noise(const Transition<T>& step, const AxisMatrix& jerk_covariance) {
    return with_error_noise(step,
                            kronecker<T, axes>(step.Q, jerk_covariance) + isotropic(step.Q_fixed));
  }

  /// Prediction step.
  KalmanState predict(const Transition<T>& step, const AxisVector& gravity,
                      const AxisMatrix& jerk_covariance) const {
    return predict_with(step, gravity, process_noise(step, jerk_covariance));
  }

  /// The same with unit jerk covariance.
  KalmanState predict(const Transition<T>& step, double gravity) const requires(axes == 1) {
    return predict_with(step, AxisVector(T(gravity)),
                        with_error_noise(step, step.Q + step.Q_fixed));
  }

  /// H x for x [size, n]: positions plus correlated errors of standard deviation
  /// `correlated_sigma`.
  template <int n>
  static Eigen::Matrix<T, axes, n> observe(const Eigen::Matrix<T, size, n>& x,
                                           const AxisVector& correlated_sigma) {
    Eigen::Matrix<T, axes, n> result = x.template topRows<axes>();
    if constexpr (has_correlated_errors)
      result += correlated_sigma.asDiagonal() * x.template bottomRows<axes>();
    return result;
  }

  /// Update step (Joseph form) with a measured position; `variance` is that of its white errors.
  /// Returns the negative log-likelihood of the innovation without its constant.
  T update(const AxisVector& position, const AxisVector& variance,
           const AxisVector& correlated_sigma = AxisVector::Zero()) {
    using std::log;
    const Eigen::Matrix<T, axes, size> cross_covariance =
        observe<size>(covariance, correlated_sigma);
    const AxisMatrix root =
        AxisMatrix(observe<axes>(cross_covariance.transpose(), correlated_sigma) +
                   AxisMatrix(variance.asDiagonal()))
            .llt()
            .matrixL();
    const auto lower = root.template triangularView<Eigen::Lower>();
    const Eigen::Matrix<T, axes, size> half = lower.solve(cross_covariance);
    const AxisVector innovation = lower.solve(position - observe<1>(mean, correlated_sigma));
    const Gain gain = lower.transpose().solve(half).transpose();
    mean += half.transpose() * innovation;
    const Square once = apply_joseph_factor(covariance, gain, correlated_sigma);
    covariance = apply_joseph_factor(once.transpose(), gain, correlated_sigma) +
                 gain * variance.asDiagonal() * gain.transpose();
    T cost = 0.5 * innovation.squaredNorm();
    for (int i = 0; i < axes; ++i) cost += log(root(i, i));
    return cost;
  }

  T update(double position, const T& variance,
           const T& correlated_sigma = T(0)) requires(axes == 1) {
    return update(AxisVector(T(position)), AxisVector(variance), AxisVector(correlated_sigma));
  }

 private:
  using Gain = Eigen::Matrix<T, size, axes>;
  using Motion = Eigen::Matrix<T, motion_size, motion_size>;

  static Motion isotropic(const Matrix3<T>& orders) {
    if constexpr (axes == 1) return orders;
    return kronecker<T, axes>(orders, AxisMatrix::Identity());
  }

  static Square with_error_noise(const Transition<T>& step, const Motion& noise) {
    if constexpr (!has_correlated_errors) return noise;
    Square Q = Square::Zero();
    Q.template topLeftCorner<motion_size, motion_size>() = noise;
    Q.diagonal().template tail<axes>().setConstant(1.0 - step.error_decay * step.error_decay);
    return Q;
  }

  KalmanState predict_with(const Transition<T>& step, const AxisVector& gravity,
                           const Square& noise) const {
    KalmanState next{propagate<1>(step, mean), propagate_covariance(step, covariance) + noise};
    for (int order = 0; order < 3; ++order)
      next.mean.template segment<axes>(axes * order) += step.u[order] * gravity;
    return next;
  }

  /// x (I - gain H)'. H is nonzero only for positions and their errors, so the other columns of x
  /// pass unchanged.
  static Square apply_joseph_factor(const Square& x, const Gain& gain,
                                    const AxisVector& correlated_sigma) {
    constexpr int unobserved = motion_size - axes;
    Gain factor = -gain;
    factor.template topRows<axes>().diagonal().array() += T(1.0);
    Square result = x.template leftCols<axes>().lazyProduct(factor.transpose());
    result.template middleCols<unobserved>(axes) += x.template middleCols<unobserved>(axes);
    if constexpr (has_correlated_errors) {
      factor = -gain * correlated_sigma.asDiagonal();
      factor.template bottomRows<axes>().diagonal().array() += T(1.0);
      result += x.template rightCols<axes>().lazyProduct(factor.transpose());
    }
    return result;
  }
};

template <class T>
using AxisState = KalmanState<T, 1>;

}  // namespace touchtrace
