#include "pipeline/label/estimate/body_residuals.h"

namespace touchtrace::label::residuals {
namespace {

using Eigen::Vector3d;
template <int rows, int cols>
using RowMajor = Eigen::Matrix<double, rows, cols, Eigen::RowMajor>;

/// Derivative by the shape of the distance by which the core extends in direction `outward` (unit
/// vector, body frame), edges included.
Eigen::RowVector4d extent_by_shape(Core core, const Vector3d& outward) {
  const Vector3d size = outward.cwiseAbs();
  if (core == Core::cylinder) return {size.head<2>().norm(), 0.0, size.z(), 1.0};
  return {size.x(), size.y(), size.z(), 1.0};
}

/// Residual of a point at `point_m` (camera frame), `weight` times `surface` (body frame).
Linearization of_surface(const SurfaceDistance& surface, double weight, const RoundedBody& body,
                         const Eigen::Isometry3d& camera_from_body, const Vector3d& point_m) {
  const Vector3d outward = camera_from_body.linear() * surface.outward,
                 arm_m = point_m - camera_from_body.translation();
  return {weight * surface.distance_m, -weight * extent_by_shape(body.core, surface.outward),
          -2.0 * weight * arm_m.cross(outward).transpose(), -weight * outward.transpose()};
}

}  // namespace

bool BodyResidual::Evaluate(const double* const* parameters, double* residuals,
                            double** jacobians) const {
  Eigen::Isometry3d pose{Eigen::Map<const Eigen::Quaterniond>(parameters[1])};
  pose.translation() = Eigen::Map<const Vector3d>{parameters[2]};
  const Linearization result = at(body_of(core_, parameters[0]), pose);
  residuals[0] = result.residual_m;
  if (!jacobians) return true;
  if (jacobians[0]) Eigen::Map<Eigen::RowVector4d>{jacobians[0]} = result.shape;
  if (jacobians[1]) {
    RowMajor<4, 3> by_half_turn;
    ceres::EigenQuaternionManifold().PlusJacobian(parameters[1], by_half_turn.data());
    // its columns are orthonormal
    Eigen::Map<Eigen::RowVector4d>{jacobians[1]} = result.half_turn * by_half_turn.transpose();
  }
  if (jacobians[2]) Eigen::Map<Eigen::RowVector3d>{jacobians[2]} = result.position;
  return true;
}

Linearization PointDistance::at(const RoundedBody& body,
                                const Eigen::Isometry3d& camera_from_body) const {
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  const Vector3d point = body_from_camera * point_m_;
  const auto surface = surface_distance(body, point);
  const double weight =
      view_.residual_weight(surface.outward, point - body_from_camera * view_.origin_m);
  return of_surface(surface, weight, body, camera_from_body, point_m_);
}

Linearization RayDepth::at(const RoundedBody& body,
                           const Eigen::Isometry3d& camera_from_body) const {
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  const auto deepest = deepest_point(body, body_from_camera * origin_m_, body_from_camera * end_m_);
  if (!deepest) return {};  // most rays
  const auto surface = surface_distance(body, *deepest);
  if (!(surface.distance_m < 0.0)) return {};
  return of_surface(surface, 1.0, body, camera_from_body, camera_from_body * *deepest);
}

Linearization PlaneDistance::at(const RoundedBody& body,
                                const Eigen::Isometry3d& camera_from_body) const {
  const Vector3d outward = camera_from_body.linear().transpose() * outward_,
                 arm_m = camera_from_body.linear() *
                         core_support_point(body.core, outward, body.inner_m);
  const double weight = 1.0 / sigma_ratio_;
  return {weight * extent_beyond_plane_m(body, camera_from_body, outward_),
          weight * extent_by_shape(body.core, outward),
          2.0 * weight * arm_m.cross(outward_).transpose(), weight * outward_.transpose()};
}

Eigen::Matrix<double, 3, 4> half_extent_jacobian(Core core) {
  Eigen::Matrix<double, 3, 4> jacobian = Eigen::Matrix<double, 3, 4>::Zero();
  jacobian(0, 0) = jacobian(2, 2) = 1.0;
  jacobian(1, static_cast<Eigen::Index>(second_width(core))) = 1.0;
  jacobian.col(3).setOnes();
  return jacobian;
}

bool Compactness::Evaluate(const double* const* parameters, double* residuals,
                           double** jacobians) const {
  Eigen::Map<Vector3d>{residuals} = weight_ * body_of(core_, parameters[0]).half_extents_m();
  if (jacobians && jacobians[0])
    Eigen::Map<RowMajor<3, 4>>{jacobians[0]} = weight_ * half_extent_jacobian(core_);
  return true;
}

}  // namespace touchtrace::label::residuals
