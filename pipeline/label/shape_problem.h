#pragma once

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/label/body_residuals.h"
#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

namespace touchtrace::label {

/// A body's shape and its pose in every view together: robust least squares of distances.
class ShapeProblem {
 public:
  using Poses = std::vector<Eigen::Isometry3d>;

  /// Begins with `body`, and with poses camera_from_body that are right but for its shape. Of a
  /// half extent `compactness` of its length counts as a distance; `width_m` is the loss's. The
  /// views must outlive it.
  ShapeProblem(const std::vector<BodyView>& views, const RoundedBody& body, const Poses& poses,
               double width_m, double compactness);
  ShapeProblem(const ShapeProblem&) = delete;
  ShapeProblem& operator=(const ShapeProblem&) = delete;

  void solve();
  RoundedBody body() const { return residuals::body_of(core_, shape_); }
  Poses poses() const;
  /// Deviations of the half extents, all poses unknown, as far as linear terms tell.
  Eigen::Vector3d half_extent_sigma_m();

 private:
  struct Pose {
    explicit Pose(const Eigen::Isometry3d& pose)
        : rotation(pose.linear()), place_m(pose.translation()) {}

    Eigen::Quaterniond rotation;
    Eigen::Vector3d place_m;
  };

  void add_view(const BodyView& view, Pose& pose, double width_m);
  template <class Residual>
  void add(Residual* residual, ceres::LossFunction* loss, Pose& pose);
  Eigen::MatrixXd normal_matrix();

  Core core_;
  residuals::Shape shape_;
  std::vector<Pose> poses_;
  ceres::Problem problem_;
};

}  // namespace touchtrace::label
