#include "calib/rig/rig_comparison.h"

#include <fmt/core.h>

#include <cmath>

#include "calib/matrix/decomposition.h"
#include "engine/base/error.h"

namespace touchtrace {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Matrix6d known_covariance(const RigCalibration& rig, std::size_t camera) {
  return rig.parameters.empty() ? Matrix6d(Matrix6d::Zero()) : pose_covariance(rig, camera);
}

PoseDifference compare_camera(const RigCalibration& a, const RigCalibration& b,
                              std::size_t camera) {
  const Eigen::Isometry3d &in_a = a.camera_from_rig[camera], &in_b = b.camera_from_rig[camera];
  const Eigen::AngleAxisd rotation(in_a.linear() * in_b.linear().transpose());
  Vector6d error;
  error << rotation.angle() * rotation.axis(), in_a.translation() - in_b.translation();
  const Matrix6d covariance = known_covariance(a, camera) + known_covariance(b, camera);
  const Vector6d weighted = solve_semidefinite(covariance, error);
  return {error.tail<3>().norm(), rotation.angle(), std::sqrt(error.dot(weighted) / 6.0)};
}

}  // namespace

std::vector<PoseDifference> compare(const RigCalibration& a, const RigCalibration& b) {
  if (a.cameras.size() != b.cameras.size())
    throw data_error(
        fmt::format("the rigs have {} and {} cameras", a.cameras.size(), b.cameras.size()),
        "compare calibrations of one rig");
  if (a.parameters.empty() && b.parameters.empty())
    throw data_error("no rig has a covariance", "give a folder of `touchtrace calibrate --camera`");
  std::vector<PoseDifference> differences;
  for (std::size_t camera = 1; camera < a.cameras.size(); ++camera)
    differences.push_back(compare_camera(a, b, camera));
  return differences;
}

}  // namespace touchtrace
