#pragma once

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>

#include "calib/camera/lens.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {

/// Reprojection error of one corner through the lens L: (projected - measured) / sigma [2].
/// Parameter blocks: intrinsics, camera_from_board, the board's warp and, if the deformation is
/// free, the corner's offset. Derivatives of the lens are automatic, all others analytic. Takes the
/// rotation from `rotation` instead of camera_from_board: requires ViewRotations as the problem's
/// evaluation callback.
template <class L>
class CornerCost final : public ceres::CostFunction {
 public:
  CornerCost(const Eigen::Vector3d& flat_m, const Eigen::Vector2d& warp_basis,
             const Eigen::Vector2d& measured_px, double sigma_px,
             const ViewRotations::Rotation& rotation, bool free_offset)
      : flat_m_(flat_m),
        warp_basis_(warp_basis),
        measured_px_(measured_px),
        sigma_px_(sigma_px),
        rotation_(rotation),
        free_offset_(free_offset) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {4 + num_coefficients, 6, 2};
    if (free_offset) mutable_parameter_block_sizes()->push_back(3);
  }

  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override {
    const double* intrinsics = parameters[0];
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[1] + 3);
    Eigen::Vector3d on_board = flat_m_;
    on_board.z() += warp_basis_.dot(Eigen::Map<const Eigen::Vector2d>(parameters[2]));
    if (free_offset_) on_board += Eigen::Map<const Eigen::Vector3d>(parameters[3]);
    const Eigen::Vector3d rotated = rotation_.matrix * on_board, p = rotated + translation;
    if (!L::can_project(p)) return false;
    Eigen::Map<Eigen::Vector2d> error(residual);
    if (jacobians == nullptr) {
      error = (project_point<L>(intrinsics, p) - measured_px_) / sigma_px_;
      return true;
    }
    std::array<Jet, num_coefficients> k;
    for (int i = 0; i < num_coefficients; ++i) k[std::size_t(i)] = Jet(intrinsics[4 + i], 3 + i);
    const Vector2<Jet> distorted = L::distort(
        k.data(), L::normalize(Vector3<Jet>(Jet(p.x(), 0), Jet(p.y(), 1), Jet(p.z(), 2))));
    for (int axis = 0; axis < 2; ++axis)
      error[axis] =
          (intrinsics[axis] * distorted[axis].a + intrinsics[2 + axis] - measured_px_[axis]) /
          sigma_px_;
    differentiate(intrinsics, rotated, distorted, jacobians);
    return true;
  }

 private:
  static constexpr int num_coefficients = static_cast<int>(L::coefficients.size());
  using Jet = ceres::Jet<double, 3 + num_coefficients>;

  void differentiate(const double* intrinsics, const Eigen::Vector3d& rotated,
                     const Vector2<Jet>& distorted, double** jacobians) const {
    Eigen::Matrix<double, 2, 3> by_point;
    for (int axis = 0; axis < 2; ++axis)
      by_point.row(axis) =
          intrinsics[axis] / sigma_px_ * distorted[axis].v.template head<3>().transpose();
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 4 + num_coefficients, Eigen::RowMajor>> by_intrinsics(
          jacobians[0]);
      by_intrinsics.setZero();
      for (int axis = 0; axis < 2; ++axis) {
        by_intrinsics(axis, axis) = distorted[axis].a / sigma_px_;
        by_intrinsics(axis, 2 + axis) = 1.0 / sigma_px_;
        by_intrinsics.row(axis).template tail<num_coefficients>() =
            intrinsics[axis] / sigma_px_ *
            distorted[axis].v.template tail<num_coefficients>().transpose();
      }
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> by_pose(jacobians[1]);
      by_pose.leftCols<3>() = -by_point * cross_matrix(rotated) * rotation_.left_jacobian;
      by_pose.rightCols<3>() = by_point;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> by_warp(jacobians[2]);
      by_warp = by_point * rotation_.matrix.col(2) * warp_basis_.transpose();
    }
    if (free_offset_ && jacobians[3] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_offset(jacobians[3]);
      by_offset = by_point * rotation_.matrix;
    }
  }

  Eigen::Vector3d flat_m_;
  Eigen::Vector2d warp_basis_, measured_px_;
  double sigma_px_;
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

/// Gaussian prior of a parameter block of N values: (value - mean) / sigma. An infinite sigma gives
/// a zero residual.
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
