#pragma once

#include <ceres/cost_function.h>
#include <ceres/rotation.h>

#include <Eigen/Core>

#include "calib/camera/projection_jacobian.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {

/// Sets the derivative [2, ..] by a parameter block, unless the block is constant.
template <class Derivative>
void set_jacobian(double* jacobian, const Eigen::MatrixBase<Derivative>& derivative) {
  if (jacobian == nullptr) return;
  Eigen::Map<Eigen::Matrix<double, 2, Derivative::ColsAtCompileTime, Eigen::RowMajor>>(
      jacobian, 2, derivative.cols()) = derivative;
}

/// Derivative of a projection by the pose that maps a point to `rotated` + translation. `by_point`:
/// its derivative by the mapped point.
inline Eigen::Matrix<double, 2, 6> derivative_by_pose(
    const Eigen::Matrix<double, 2, 3>& by_point, const Eigen::Vector3d& rotated,
    const Eigen::Matrix3d& left_rotation_jacobian) {
  Eigen::Matrix<double, 2, 6> by_pose;
  by_pose << -by_point * cross_matrix(rotated) * left_rotation_jacobian, by_point;
  return by_pose;
}

/// A measured corner of the board. Reprojection errors are (projected - measured) / sigma [2].
struct CornerMeasurement {
  Lens lens;
  Eigen::Vector3d flat_m;      ///< on the ideal board
  Eigen::Vector2d warp_basis;  ///< CalibrationTarget::warp_basis() there
  Eigen::Vector2d pixel;
  double sigma_px;

  /// Place on the warped board.
  Eigen::Vector3d warped_m(const double* warp_m) const {
    Eigen::Vector3d place_m = flat_m;
    place_m.z() += warp_basis.dot(Eigen::Map<const Eigen::Vector2d>(warp_m));
    return place_m;
  }
  /// Sets the error of the corner at `point_m` of the camera frame. Returns whether it is finite.
  bool set_error(const double* intrinsics, const Eigen::Vector3d& point_m, double* error) const {
    Eigen::Map<Eigen::Vector2d> set(error);
    set = (project_point(lens, intrinsics, point_m) - pixel) / sigma_px;
    return set.allFinite();
  }
  /// The error, as ProjectionJacobian::pixel, and its derivatives.
  ProjectionJacobian differentiate(const double* intrinsics, const Eigen::Vector3d& point_m) const {
    ProjectionJacobian error = projection_jacobian(lens, intrinsics, point_m);
    error.pixel = (error.pixel - pixel) / sigma_px;
    error.by_point /= sigma_px, error.by_intrinsics /= sigma_px;
    return error;
  }
};

/// Reprojection error of one corner. Parameter blocks: intrinsics, camera_from_board, the board's
/// warp and, if the deformation is free, the corner's offset. Takes the rotation from `rotation`
/// instead of camera_from_board: requires ViewRotations as the problem's evaluation callback.
class CornerCost final : public ceres::CostFunction {
 public:
  CornerCost(const CornerMeasurement& corner, const ViewRotations::Rotation& rotation,
             bool free_offset)
      : corner_(corner), rotation_(rotation), free_offset_(free_offset) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {num_intrinsics(corner.lens), 6, 2};
    if (free_offset) mutable_parameter_block_sizes()->push_back(3);
  }

  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override {
    using Vector = Eigen::Map<const Eigen::Vector3d>;
    Eigen::Vector3d on_board = corner_.warped_m(parameters[2]);
    if (free_offset_) on_board += Vector(parameters[3]);
    const Eigen::Vector3d rotated = rotation_.matrix * on_board,
                          p = rotated + Vector(parameters[1] + 3);
    if (jacobians == nullptr) return corner_.set_error(parameters[0], p, residual);
    const ProjectionJacobian error = corner_.differentiate(parameters[0], p);
    Eigen::Map<Eigen::Vector2d>{residual} = error.pixel;
    const Eigen::Matrix<double, 2, 3> by_board_point = error.by_point * rotation_.matrix;
    set_jacobian(jacobians[0], error.by_intrinsics.leftCols(parameter_block_sizes()[0]));
    set_jacobian(jacobians[1],
                 derivative_by_pose(error.by_point, rotated, rotation_.left_jacobian));
    set_jacobian(jacobians[2], by_board_point.col(2) * corner_.warp_basis.transpose());
    if (free_offset_) set_jacobian(jacobians[3], by_board_point);
    return error.pixel.allFinite();
  }

 private:
  CornerMeasurement corner_;
  const ViewRotations::Rotation& rotation_;
  bool free_offset_;
};

/// Depth [m] of the board along the ray of the sample's pixel. `depth`: fx fy cx cy.
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
  const T warp = T(sample.warp_basis.x()) * warp_m[0] + T(sample.warp_basis.y()) * warp_m[1];
  return (normal.dot(origin) + warp) / normal.dot(ray);
}

/// Error of one depth sample in measured depth: (model - measured) / sigma. `correction`: scale,
/// offset.
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

}  // namespace touchtrace
