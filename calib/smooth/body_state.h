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

  static Square transition(const Transition<T>& step) {
    Square F = Square::Zero();
    F.template topLeftCorner<motion, motion>() = spread(step.F);
    if constexpr (correlated) F.diagonal().template tail<axes>().setConstant(step.error_kept);
    return F;
  }

  /// `jerk`: how freely the axes move, see Transition.
  static Square noise(const Transition<T>& step, const Between& jerk) {
    Square Q = Square::Zero();
    Q.template topLeftCorner<motion, motion>() =
        kronecker<T, axes>(step.Q, jerk) + spread(step.Q_free);
    if constexpr (correlated)
      Q.diagonal().template tail<axes>().setConstant(1.0 - step.error_kept * step.error_kept);
    return Q;
  }

  BodyState after(const Transition<T>& step, const Place& gravity, const Between& jerk) const {
    const Square F = transition(step);
    BodyState next{F * mean, F * covariance * F.transpose() + noise(step, jerk)};
    for (int order = 0; order < 3; ++order)
      next.mean.template segment<axes>(axes * order) += step.u[order] * gravity;
    return next;
  }

  BodyState after(const Transition<T>& step, double gravity) const requires(axes == 1) {
    return after(step, Place(T(gravity)), Between::Identity());
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
    const Eigen::Matrix<T, size, axes> gain = lower.transpose().solve(half).transpose();
    Square keep = Square::Identity();
    keep.template leftCols<axes>() -= gain;
    if constexpr (correlated)
      keep.template rightCols<axes>() -= gain * correlated_sigma.asDiagonal();
    mean += half.transpose() * innovation;
    covariance =
        (keep * covariance * keep.transpose() + gain * variance.asDiagonal() * gain.transpose())
            .eval();
    T cost = 0.5 * innovation.squaredNorm();
    for (int i = 0; i < axes; ++i) cost += log(root(i, i));
    return cost;
  }

  T measure(double position, const T& variance,
            const T& correlated_sigma = T(0)) requires(axes == 1) {
    return measure(Place(T(position)), Place(variance), Place(correlated_sigma));
  }

 private:
  static Eigen::Matrix<T, motion, motion> spread(const Matrix3<T>& orders) {
    return kronecker<T, axes>(orders, Between::Identity());
  }
};

template <class T>
using AxisState = BodyState<T, 1>;

}  // namespace touchtrace
