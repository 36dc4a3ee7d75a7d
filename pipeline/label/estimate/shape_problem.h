#pragma once

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/label/estimate/body_residuals.h"
#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

namespace touchtrace::label {

/// Joint robust least squares over a body's shape and its pose in every view, in Ceres. The cost is
/// that of BodyView plus a compactness prior: the squared half extents times `compactness` squared.
class ShapeProblem {
 public:
  using Poses = std::vector<Eigen::Isometry3d>;  ///< camera_from_body

  /// `body`, `poses`: start values; the poses should fit `body`. `loss_width_m`: of
  /// GemanMcClureLoss. The views must outlive the problem.
  ShapeProblem(const std::vector<BodyView>& views, const RoundedBody& body, const Poses& poses,
               double loss_width_m, double compactness);
  ShapeProblem(const ShapeProblem&) = delete;
  ShapeProblem& operator=(const ShapeProblem&) = delete;

  void solve();
  RoundedBody body() const { return residuals::body_of(core_, shape_.data()); }
  Poses poses() const;
  /// Standard deviations of the half extents, poses marginalised; first order, for independent
  /// points of `point_sigma_m`.
  Eigen::Vector3d half_extent_sigma_m();

 private:
  struct Pose {
    explicit Pose(const Eigen::Isometry3d& pose)
        : rotation(pose.linear()), position_m(pose.translation()) {}

    Eigen::Quaterniond rotation;
    Eigen::Vector3d position_m;
  };

  void add_view(const BodyView& view, Pose& pose, double loss_width_m);
  /// J' J; the shape comes first.
  Eigen::MatrixXd normal_matrix();

  Core core_;
  residuals::Shape shape_;
  std::vector<Pose> poses_;
  ceres::Problem problem_;
};

}  // namespace touchtrace::label
