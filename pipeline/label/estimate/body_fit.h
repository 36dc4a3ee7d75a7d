#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

namespace touchtrace::label {

/// Pose of a rounded body in one view.
struct BodyFit {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Eigen::Isometry3d camera_from_body = Eigen::Isometry3d::Identity();
  /// Information of (centre [m], rotation [rad]) along the camera's axes, for residuals of variance
  /// 1 m^2; includes the prior.
  Matrix6 information = Matrix6::Zero();
  double cost_m2 = 0.0;  ///< at the minimum, prior included

  Eigen::Vector3d centre_m() const { return camera_from_body.translation(); }
  /// Information of the centre with the rotation marginalised (Schur complement).
  Eigen::Matrix3d centre_information() const;
};

/// Rough centre of a body: behind the centroid of its surface points.
Eigen::Vector3d initial_centre(const BodyView& view, const RoundedBody& body);

/// Subset of a view: evenly at most about `max_points` surface points, and as many of the rays that
/// pass within `reach_m` of `centre_m`.
BodyView subsample(const BodyView& view, const Eigen::Vector3d& centre_m, double reach_m,
                   std::size_t max_points);

/// At most about `max_points` points, evenly spread.
std::vector<Eigen::Vector3f> every_nth(const std::vector<Eigen::Vector3f>& points,
                                       std::size_t max_points);

/// Median distance of points [camera's frame] from a body's surface; there must be at least one.
double median_distance_m(const std::vector<Eigen::Vector3f>& points, const RoundedBody& body,
                         const Eigen::Isometry3d& camera_from_body);

/// Prior standard deviation of an unknown rotation.
inline constexpr double unknown_rotation_sigma_rad = 3.0;

/// Fits the pose of a body of known shape (cost: BodyView) from `start`, with the coarse loss, then
/// the fine one. Prior: rotation about `start` with `rotation_sigma_rad`. All fits below require at
/// least one surface point.
BodyFit fit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                 double rotation_sigma_rad);

/// fit_body with the fine loss alone, for an accurate start.
BodyFit refit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                   double rotation_sigma_rad);

/// Fits from rotations spread over SO(3). Returns the best few local minima by increasing cost;
/// some may coincide. `position_weight`: of the prior that the centre is at initial_centre. It
/// matters where a hand leaves only a strip of the body visible.
std::vector<BodyFit> global_pose_candidates(const BodyView& view, const RoundedBody& body,
                                            double position_weight = 1.0);
/// Best candidate with a negligible position prior, for shape learning. The prior is not robust:
/// where a hand hides so much of a long body that initial_centre is 13 mm off, weight 1 costs as
/// much as ten outliers and the body would be learnt too short.
BodyFit fit_body_globally(const BodyView& view, const RoundedBody& body);

/// Best fit from `start` and from those of its turns that exchange the body's axes, with a
/// negligible position prior.
BodyFit fit_body_near(const BodyView& view, const RoundedBody& body,
                      const Eigen::Isometry3d& start);

}  // namespace touchtrace::label
