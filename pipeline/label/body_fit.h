#pragma once

#include <Eigen/Geometry>

#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

namespace touchtrace::label {

/// A rounded body in one view.
struct BodyFit {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Eigen::Isometry3d camera_from_body = Eigen::Isometry3d::Identity();
  /// Of its centre [m] and its rotation [rad], both along the camera's axes, per m^2 of residual;
  /// what was known before is in it.
  Matrix6 information = Matrix6::Zero();
  double cost_m2 = 0.0;  ///< loss of all distances from the surface

  Eigen::Vector3d center_m() const { return camera_from_body.translation(); }
  /// Of the centre alone, whatever the rotation is.
  Eigen::Matrix3d center_information() const;
};

/// Behind the middle of what is seen.
Eigen::Vector3d likely_center(const BodyView& view, const RoundedBody& body);

/// A view with at most so many points and rays, spread evenly; of the rays only those that pass
/// within `reach_m` of `center_m`.
BodyView thinned(const BodyView& view, const Eigen::Vector3d& center_m, double reach_m,
                 std::size_t most);

/// Deviation of a rotation of which nothing is known.
inline constexpr double unknown_rad = 3.0;

/// Place and rotation of a body of known shape near `start`: Levenberg-Marquardt with a robust
/// loss, wide at first, of the distances between surface and points and of the depths to which rays
/// enter it. Its rotation is known before to `rotation_sigma_rad`. `on_m` must not be empty.
BodyFit fit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                 double rotation_sigma_rad);

/// The same from a start that is right but for what moved since: with the narrow loss alone.
BodyFit refit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                   double rotation_sigma_rad);

/// The same where nothing is known of the rotation, from rotations all around: the few best, the
/// very best first. Some may be the same. That its middle is behind the middle of what is seen is
/// worth `place_points`: of a strip that shows through a hand, little else tells where it is.
std::vector<BodyFit> fits_anyhow(const BodyView& view, const RoundedBody& body,
                                 double place_points = 1.0);
/// The best of them where that is worth next to nothing: no loss bounds it, and one point's worth
/// costs as much as ten strays where a hand hides so much of a long body that it is 13 mm off,
/// which would be learnt too short.
BodyFit fit_body_anyhow(const BodyView& view, const RoundedBody& body);

}  // namespace touchtrace::label
