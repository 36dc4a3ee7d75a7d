#pragma once

#include <Eigen/Cholesky>

#include "calib/smooth/motion_prior.h"

namespace touchtrace {

/// [3 axes, 3 axes]: `orders` of (position, velocity, acceleration), each of them `between` axes.
template <class T, int axes>
Eigen::Matrix<T, 3 * axes, 3 * axes> kronecker(const Matrix3<T>& orders,
                                               const Eigen::Matrix<T, axes, axes>& between) {
  if constexpr (axes == 1) return orders * between(0, 0);
  Eigen::Matrix<T, 3 * axes, 3 * axes> product;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      product.template block<axes, axes>(axes * i, axes * j) = orders(i, j) * between;
  return product;
}

/// a b, column by column: Eigen's product of such sizes is made for large ones, and takes twice as
/// long.
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

/// Whether a measurement errs as its neighbours do.
enum class Errors { white, correlated };

/// The Kalman filter of `axes` axes that move together: positions, then velocities, then
/// accelerations, then, where errors are correlated, their correlated part in its deviations.
/// Covariances are sums of squares, never differences.
template <class T, int axes_, Errors errors = Errors::white>
struct BodyState {
  static constexpr int axes = axes_, motion = 3 * axes;
  static constexpr bool correlated = errors == Errors::correlated;
  static constexpr int size = correlated ? motion + axes : motion;
  using Place = Eigen::Matrix<T, axes, 1>;
  using Between = Eigen::Matrix<T, axes, axes>;
  using Vector = Eigen::Matrix<T, size, 1>;
  using Square = Eigen::Matrix<T, size, size>;

  Vector mean = Vector::Zero();
  Square covariance = Square::Zero();

  /// x [size, n], a state or several, as the transition moves it: every axis in the same way.
  template <int n>
  static Eigen::Matrix<T, size, n> moved(const Transition<T>& step,
                                         const Eigen::Matrix<T, size, n>& x) {
    Eigen::Matrix<T, size, n> result;
    for (int i = 0; i < 3; ++i)
      result.template middleRows<axes>(axes * i) =
          step.F(i, 0) * x.template topRows<axes>() +
          step.F(i, 1) * x.template middleRows<axes>(axes) +
          step.F(i, 2) * x.template middleRows<axes>(2 * axes);
    if constexpr (correlated)
      result.template bottomRows<axes>() = step.error_kept * x.template bottomRows<axes>();
    return result;
  }

  /// F p F'
  static Square moved_covariance(const Transition<T>& step, const Square& p) {
    const Square once = moved<size>(step, p);
    return moved<size>(step, once.transpose());
  }

  /// `jerk`: how freely the axes move, see Transition.
  static Square noise(const Transition<T>& step, const Between& jerk) {
    return with_new_errors(step, kronecker<T, axes>(step.Q, jerk) + spread(step.Q_free));
  }

  BodyState after(const Transition<T>& step, const Place& gravity, const Between& jerk) const {
    return after_with(step, gravity, noise(step, jerk));
  }

  /// Freely.
  BodyState after(const Transition<T>& step, double gravity) const requires(axes == 1) {
    return after_with(step, Place(T(gravity)), with_new_errors(step, step.Q + step.Q_free));
  }

  /// What is measured of `x` [size, n], a state or several: positions with their correlated errors,
  /// which have the deviations `correlated_sigma`.
  template <int n>
  static Eigen::Matrix<T, axes, n> measured(const Eigen::Matrix<T, size, n>& x,
                                            const Place& correlated_sigma) {
    Eigen::Matrix<T, axes, n> result = x.template topRows<axes>();
    if constexpr (correlated)
      result += correlated_sigma.asDiagonal() * x.template bottomRows<axes>();
    return result;
  }

  /// Takes in a measured position (Joseph's form), `variance` that of its white errors; returns
  /// -log of its likelihood, without the constant.
  T measure(const Place& position, const Place& variance,
            const Place& correlated_sigma = Place::Zero()) {
    using std::log;
    const Eigen::Matrix<T, axes, size> with_state = measured<size>(covariance, correlated_sigma);
    const Between root = Between(measured<axes>(with_state.transpose(), correlated_sigma) +
                                 Between(variance.asDiagonal()))
                             .llt()
                             .matrixL();
    const auto lower = root.template triangularView<Eigen::Lower>();
    const Eigen::Matrix<T, axes, size> half = lower.solve(with_state);
    const Place innovation = lower.solve(position - measured<1>(mean, correlated_sigma));
    const Gain gain = lower.transpose().solve(half).transpose();
    mean += half.transpose() * innovation;
    const Square kept_once = kept(covariance, gain, correlated_sigma);
    covariance = kept(kept_once.transpose(), gain, correlated_sigma) +
                 gain * variance.asDiagonal() * gain.transpose();
    T cost = 0.5 * innovation.squaredNorm();
    for (int i = 0; i < axes; ++i) cost += log(root(i, i));
    return cost;
  }

  T measure(double position, const T& variance,
            const T& correlated_sigma = T(0)) requires(axes == 1) {
    return measure(Place(T(position)), Place(variance), Place(correlated_sigma));
  }

 private:
  using Gain = Eigen::Matrix<T, size, axes>;
  using Motion = Eigen::Matrix<T, motion, motion>;

  static Motion spread(const Matrix3<T>& orders) {
    if constexpr (axes == 1) return orders;
    return kronecker<T, axes>(orders, Between::Identity());
  }

  static Square with_new_errors(const Transition<T>& step, const Motion& noise) {
    if constexpr (!correlated) return noise;
    Square Q = Square::Zero();
    Q.template topLeftCorner<motion, motion>() = noise;
    Q.diagonal().template tail<axes>().setConstant(1.0 - step.error_kept * step.error_kept);
    return Q;
  }

  BodyState after_with(const Transition<T>& step, const Place& gravity, const Square& noise) const {
    BodyState next{moved<1>(step, mean), moved_covariance(step, covariance) + noise};
    for (int order = 0; order < 3; ++order)
      next.mean.template segment<axes>(axes * order) += step.u[order] * gravity;
    return next;
  }

  /// x (I - gain H)', of which most columns are those of x: H sees positions and their errors.
  static Square kept(const Square& x, const Gain& gain, const Place& correlated_sigma) {
    constexpr int unseen = motion - axes;
    Gain keep = -gain;
    keep.template topRows<axes>().diagonal().array() += T(1.0);
    Square result = x.template leftCols<axes>().lazyProduct(keep.transpose());
    result.template middleCols<unseen>(axes) += x.template middleCols<unseen>(axes);
    if constexpr (correlated) {
      keep = -gain * correlated_sigma.asDiagonal();
      keep.template bottomRows<axes>().diagonal().array() += T(1.0);
      result += x.template rightCols<axes>().lazyProduct(keep.transpose());
    }
    return result;
  }
};

template <class T>
using AxisState = BodyState<T, 1>;

}  // namespace touchtrace
