#pragma once

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <memory>

#include "calib/camera/lens.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {

/// A view's rotation, worked out once for all of its corners. For one thread.
class ViewRotation {
 public:
  void take(const Eigen::Vector3d& turn) {
    if (turn == turn_) return;
    turn_ = turn;
    matrix = rotation_matrix(turn);
    jacobian = left_jacobian(turn);
  }

  Eigen::Matrix3d matrix, jacobian;  ///< as rotation_matrix and left_jacobian give them

 private:
  Eigen::Vector3d turn_ =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  // equals none
};

/// One corner's pixel through the lens L, projected minus measured, in units of sigma. Parameters:
/// intrinsics, camera_from_board, the board's warp and, if it is free, the corner's offset. The
/// lens is differentiated automatically, what is before it by hand.
template <class L>
class CornerCost final : public ceres::CostFunction {
 public:
  CornerCost(const Eigen::Vector3d& flat_m, const Eigen::Vector2d& warp_shape,
             const Eigen::Vector2d& measured_px, double sigma_px,
             std::shared_ptr<ViewRotation> rotation, bool free_offset)
      : flat_m_(flat_m),
        warp_shape_(warp_shape),
        measured_px_(measured_px),
        sigma_px_(sigma_px),
        rotation_(std::move(rotation)),
        free_offset_(free_offset) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {4 + coefficients, 6, 2};
    if (free_offset) mutable_parameter_block_sizes()->push_back(3);
  }

  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override {
    const double *color = parameters[0], *pose = parameters[1];
    const Eigen::Map<const Eigen::Vector3d> turn(pose), shift(pose + 3);
    rotation_->take(turn);
    Eigen::Vector3d on_board = flat_m_;
    on_board.z() += warp_shape_.dot(Eigen::Map<const Eigen::Vector2d>(parameters[2]));
    if (free_offset_) on_board += Eigen::Map<const Eigen::Vector3d>(parameters[3]);
    const Eigen::Vector3d turned = rotation_->matrix * on_board, p = turned + shift;
    if (!L::sees(p)) return false;
    Eigen::Map<Eigen::Vector2d> error(residual);
    if (jacobians == nullptr) {
      error = (project_point<L>(color, p) - measured_px_) / sigma_px_;
      return true;
    }
    std::array<Jet, coefficients> k;
    for (int i = 0; i < coefficients; ++i) k[std::size_t(i)] = Jet(color[4 + i], 3 + i);
    const Vector2<Jet> bent =
        L::bend(k.data(), L::spread(Vector3<Jet>(Jet(p.x(), 0), Jet(p.y(), 1), Jet(p.z(), 2))));
    for (int axis = 0; axis < 2; ++axis)
      error[axis] = (color[axis] * bent[axis].a + color[2 + axis] - measured_px_[axis]) / sigma_px_;
    differentiate(color, turned, bent, jacobians);
    return true;
  }

 private:
  static constexpr int coefficients = static_cast<int>(L::coefficients.size());
  using Jet = ceres::Jet<double, 3 + coefficients>;

  void differentiate(const double* color, const Eigen::Vector3d& turned, const Vector2<Jet>& bent,
                     double** jacobians) const {
    Eigen::Matrix<double, 2, 3> by_point;
    for (int axis = 0; axis < 2; ++axis)
      by_point.row(axis) = color[axis] / sigma_px_ * bent[axis].v.template head<3>().transpose();
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 4 + coefficients, Eigen::RowMajor>> by_color(
          jacobians[0]);
      by_color.setZero();
      for (int axis = 0; axis < 2; ++axis) {
        by_color(axis, axis) = bent[axis].a / sigma_px_;
        by_color(axis, 2 + axis) = 1.0 / sigma_px_;
        by_color.row(axis).template tail<coefficients>() =
            color[axis] / sigma_px_ * bent[axis].v.template tail<coefficients>().transpose();
      }
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> by_pose(jacobians[1]);
      by_pose.leftCols<3>() = -by_point * cross_matrix(turned) * rotation_->jacobian;
      by_pose.rightCols<3>() = by_point;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> by_warp(jacobians[2]);
      by_warp = by_point * rotation_->matrix.col(2) * warp_shape_.transpose();
    }
    if (free_offset_ && jacobians[3] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_offset(jacobians[3]);
      by_offset = by_point * rotation_->matrix;
    }
  }

  Eigen::Vector3d flat_m_;
  Eigen::Vector2d warp_shape_, measured_px_;
  double sigma_px_;
  std::shared_ptr<ViewRotation> rotation_;
  bool free_offset_;
};

/// Depth of the board along the ray of the sample's pixel; `depth`: fx fy cx cy.
template <class T>
T board_depth(const DepthSample& sample, const T* camera_from_board, const T* depth_from_color,
              const T* depth, const T* warp_m, const T& delay_s) {
  const Vector3<T> board_normal(T(0), T(0), T(1));
  Vector3<T> color_normal, normal, origin;
  ceres::AngleAxisRotatePoint(camera_from_board, board_normal.data(), color_normal.data());
  const T later_s = delay_s + T(sample.motion.depth_after_color_s);
  color_normal += later_s * sample.motion.angular_rad_s.cast<T>().cross(color_normal).eval();
  const Vector3<T> color_origin = Eigen::Map<const Vector3<T>>(camera_from_board + 3) +
                                  later_s * sample.motion.linear_m_s.cast<T>();
  ceres::AngleAxisRotatePoint(depth_from_color, color_normal.data(), normal.data());
  ceres::AngleAxisRotatePoint(depth_from_color, color_origin.data(), origin.data());
  origin += Eigen::Map<const Vector3<T>>(depth_from_color + 3);
  const Vector3<T> ray((T(sample.pixel.x()) - depth[2]) / depth[0],
                       (T(sample.pixel.y()) - depth[3]) / depth[1], T(1));
  const T warp = T(sample.warp_shape.x()) * warp_m[0] + T(sample.warp_shape.y()) * warp_m[1];
  return (normal.dot(origin) + warp) / normal.dot(ray);
}

/// Measured depth, model minus measurement, in units of sigma; `correction`: scale, offset.
struct DepthError {
  DepthSample sample;

  template <class T>
  bool operator()(const T* camera_from_board, const T* depth_from_color, const T* depth,
                  const T* correction, const T* warp_m, const T* delay_s, T* residual) const {
    const T surface =
        board_depth(sample, camera_from_board, depth_from_color, depth, warp_m, *delay_s);
    residual[0] =
        ((surface - correction[1]) / correction[0] - T(sample.measured_m)) / T(sample.sigma_m);
    return true;
  }
};

/// A parameter block of N against its mean, in units of sigma; an infinite sigma weighs nothing.
template <int N>
struct PriorError {
  std::array<double, N> mean, sigma;

  template <class T>
  bool operator()(const T* values, T* residual) const {
    for (int i = 0; i < N; ++i) residual[i] = (values[i] - T(mean[i])) / T(sigma[i]);
    return true;
  }
};

}  // namespace touchtrace
