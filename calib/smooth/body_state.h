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

/// The Kalman filter of `axes` axes that move together: positions, then velocities, then
/// accelerations. Covariances are sums of squares, never differences.
template <class T, int axes>
struct BodyState {
  using Place = Eigen::Matrix<T, axes, 1>;
  using Between = Eigen::Matrix<T, axes, axes>;
  using Vector = Eigen::Matrix<T, 3 * axes, 1>;
  using Square = Eigen::Matrix<T, 3 * axes, 3 * axes>;

  Vector mean = Vector::Zero();
  Square covariance = Square::Zero();

  static Square spread(const Matrix3<T>& orders) {
    return kronecker<T, axes>(orders, Between::Identity());
  }

  /// `jerk`: how freely the axes move, see Transition.
  BodyState after(const Transition<T>& step, const Place& gravity, const Between& jerk) const {
    const Square F = spread(step.F);
    BodyState next{F * mean, F * covariance * F.transpose() + noise(step, jerk)};
    for (int order = 0; order < 3; ++order)
      next.mean.template segment<axes>(axes * order) += step.u[order] * gravity;
    return next;
  }

  BodyState after(const Transition<T>& step, double gravity) const requires(axes == 1) {
    return after(step, Place(T(gravity)), Between::Identity());
  }

  static Square noise(const Transition<T>& step, const Between& jerk) {
    return kronecker<T, axes>(step.Q, jerk) + spread(step.Q_free);
  }

  /// Takes in a measured position (Joseph's form); returns -log of its likelihood, without the
  /// constant.
  T measure(const Place& position, const Place& variance) {
    using std::log;
    const Between root =
        Between(covariance.template topLeftCorner<axes, axes>() + Between(variance.asDiagonal()))
            .llt()
            .matrixL();
    const auto lower = root.template triangularView<Eigen::Lower>();
    const Eigen::Matrix<T, axes, 3 * axes> half = lower.solve(covariance.template topRows<axes>());
    const Place innovation = lower.solve(position - mean.template head<axes>());
    const Eigen::Matrix<T, 3 * axes, axes> gain = lower.transpose().solve(half).transpose();
    Square keep = Square::Identity();
    keep.template leftCols<axes>() -= gain;
    mean += half.transpose() * innovation;
    covariance =
        (keep * covariance * keep.transpose() + gain * variance.asDiagonal() * gain.transpose())
            .eval();
    T cost = 0.5 * innovation.squaredNorm();
    for (int i = 0; i < axes; ++i) cost += log(root(i, i));
    return cost;
  }

  T measure(double position, const T& variance) requires(axes == 1) {
    return measure(Place(T(position)), Place(variance));
  }
};

template <class T>
using AxisState = BodyState<T, 1>;

}  // namespace touchtrace
