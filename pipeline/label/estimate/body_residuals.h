#pragma once

#include <ceres/ceres.h>

#include <array>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

/// Ceres residuals [m] and loss of ShapeProblem.
namespace touchtrace::label::residuals {

/// Half extents of the core and radius of the edges [m].
using Shape = std::array<double, 4>;

/// Index of the core's y extent: a cylinder uses its x extent for both.
inline std::size_t second_width(Core core) { return core == Core::cylinder ? 0 : 1; }

inline RoundedBody body_of(Core core, const double* shape) {
  return {{shape[0], shape[second_width(core)], shape[2]}, shape[3], core};
}

/// A residual of a body in one view and its derivatives.
struct Linearization {
  double residual_m = 0.0;
  Eigen::RowVector4d shape = Eigen::RowVector4d::Zero();
  /// By half of a turn about the camera's axes, which is the step of EigenQuaternionManifold.
  Eigen::RowVector3d half_turn = Eigen::RowVector3d::Zero();
  Eigen::RowVector3d position = Eigen::RowVector3d::Zero();
};

/// Residual of one body in one view. Parameters: shape [4], rotation [4, quaternion x y z w, camera
/// from body, with an EigenQuaternionManifold], position [3]. Derivatives by the rotation are those
/// along the manifold.
class BodyResidual : public ceres::SizedCostFunction<1, 4, 4, 3> {
 public:
  explicit BodyResidual(Core core) : core_(core) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const final;

 private:
  virtual Linearization at(const RoundedBody& body,
                           const Eigen::Isometry3d& camera_from_body) const = 0;

  Core core_;
};

/// Distance of a point to the surface times its residual_weight(), which is not differentiated.
class PointDistance final : public BodyResidual {
 public:
  /// `view` must outlive the residual. `point_m`: camera frame.
  PointDistance(const BodyView& view, Core core, const Eigen::Vector3d& point_m)
      : BodyResidual(core), view_(view), point_m_(point_m) {}

 private:
  Linearization at(const RoundedBody& body,
                   const Eigen::Isometry3d& camera_from_body) const override;

  const BodyView& view_;
  Eigen::Vector3d point_m_;
};

/// Depth by which a ray enters the body (negative); 0 if it misses it. The position of the deepest
/// point along the ray is not differentiated: at the deepest point that derivative is 0.
class RayDepth final : public BodyResidual {
 public:
  RayDepth(Core core, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& end_m)
      : BodyResidual(core), origin_m_(origin_m), end_m_(end_m) {}

 private:
  Linearization at(const RoundedBody& body,
                   const Eigen::Isometry3d& camera_from_body) const override;

  Eigen::Vector3d origin_m_, end_m_;
};

/// Signed distance by which the body extends beyond a box plane, over the planes' sigma_ratio.
class PlaneDistance final : public BodyResidual {
 public:
  PlaneDistance(const BoxPlanes& planes, Core core, const Eigen::Vector3d& outward)
      : BodyResidual(core), sigma_ratio_(planes.sigma_ratio), outward_(outward) {}

 private:
  Linearization at(const RoundedBody& body,
                   const Eigen::Isometry3d& camera_from_body) const override;

  double sigma_ratio_;
  Eigen::Vector3d outward_;
};

/// Half extents times `weight`: a prior for small bodies. Parameter: shape.
class Compactness final : public ceres::SizedCostFunction<3, 4> {
 public:
  Compactness(Core core, double weight) : core_(core), weight_(weight) {}
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Core core_;
  double weight_;
};

/// Jacobian of the half extents by the shape.
Eigen::Matrix<double, 3, 4> half_extent_jacobian(Core core);

/// GemanMcClureLoss as Ceres wants it: twice the cost, as a function of the squared residual.
class SquaredGemanMcClureLoss : public ceres::LossFunction {
 public:
  explicit SquaredGemanMcClureLoss(double width_m) : loss_{width_m} {}

  void Evaluate(double square_m2, double rho[3]) const override {
    const double inlier = loss_.inlier_factor(square_m2);
    rho[0] = inlier * square_m2;
    rho[1] = inlier * inlier;
    rho[2] = -2.0 * inlier * inlier * inlier / (loss_.width_m * loss_.width_m);
  }

 private:
  GemanMcClureLoss loss_;
};

}  // namespace touchtrace::label::residuals
