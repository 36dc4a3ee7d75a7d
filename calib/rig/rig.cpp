#include "calib/rig/rig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace {

Eigen::Matrix<double, 6, 6> pose_covariance(const RigCalibration& rig, std::size_t camera) {
  const auto first =
      std::ranges::find(rig.parameters, rig.names[camera] + "_from_" + rig.names.front() + ".rx");
  if (rig.parameters.end() - first < 6)
    return Eigen::Matrix<double, 6, 6>::Constant(std::numeric_limits<double>::quiet_NaN());
  const auto at = first - rig.parameters.begin();
  return rig.covariance.block<6, 6>(at, at);
}

RelativePose relative_pose(const RigCalibration& rig, std::size_t camera) {
  const auto covariance = pose_covariance(rig, camera);
  const Eigen::Isometry3d& pose = rig.camera_from_rig[camera];
  const Eigen::AngleAxisd rotation(pose.linear());
  const Eigen::Vector3d axis = rotation.axis(), direction = pose.translation().normalized();
  return {pose.translation().norm(),
          std::sqrt(direction.dot(covariance.bottomRightCorner<3, 3>() * direction)),
          rotation.angle(), std::sqrt(axis.dot(covariance.topLeftCorner<3, 3>() * axis))};
}

}  // namespace touchtrace
