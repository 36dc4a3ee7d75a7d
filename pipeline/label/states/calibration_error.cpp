#include "pipeline/label/states/calibration_error.h"

#include <algorithm>
#include <cmath>

#include "calib/matrix/product.h"

namespace touchtrace::label {
namespace {

using Eigen::Index;

constexpr double velocity_step_s = 0.01;

/// The camera of the depth images; of a colour-only calibration its only camera.
Camera& depth_camera(RgbdCalibration& calibration) {
  return calibration.depth ? *calibration.depth : calibration.color;
}

/// Changes the translation or rotation along the axis that a parameter's name ends with, e.g. tx.
void move_pose(Eigen::Isometry3d& pose, const std::string& name, double by) {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(name.back() - 'x');
  if (name[name.size() - 2] == 't')
    pose.translation() += by * axis;
  else
    pose.linear() = Eigen::AngleAxisd(by, axis) * pose.linear();
}

/// Changes a parameter. Returns false if labels do not depend on it.
bool shift(RgbdCalibration& calibration, const std::string& name, double by) {
  auto& camera = depth_camera(calibration);
  const auto intrinsics = intrinsic_names(camera.lens);
  const std::string camera_name = calibration.depth ? "depth." : "color.";
  const auto intrinsic =
      std::ranges::find_if(intrinsics, [&](const auto& i) { return name == camera_name + i; });
  if (intrinsic != intrinsics.end()) {
    auto values = camera.parameters();
    values[static_cast<std::size_t>(intrinsic - intrinsics.begin())] += by;
    camera.set_parameters(values);
  } else if (name.starts_with("depth_from_color.")) {
    move_pose(calibration.depth_from_color, name, by);
  } else if (name == "depth.scale") {
    calibration.depth_scale += by;
  } else if (name == "depth.offset") {
    calibration.depth_offset_m += by;
  } else if (name == "depth.delay") {
    calibration.depth_delay_s += by;
  } else {
    return false;
  }
  return true;
}

Eigen::MatrixXd correlation(const Eigen::MatrixXd& covariance, const std::vector<Index>& indices) {
  const Eigen::MatrixXd selected = covariance(indices, indices);
  const Eigen::VectorXd inverse = selected.diagonal().cwiseSqrt().cwiseInverse();
  return inverse.asDiagonal() * selected * inverse.asDiagonal();
}

}  // namespace

CalibrationError::Lift::Lift(const RgbdCalibration& c)
    : camera(c.depth ? *c.depth : c.color),
      camera_from_color(c.depth_from_color),
      scale(c.depth_scale),
      offset_m(c.depth_offset_m),
      delay_s(c.depth_delay_s) {}

Eigen::Vector3d CalibrationError::Lift::measurement(const Eigen::Vector3d& position_m) const {
  const Eigen::Vector3d point = camera_from_color * position_m;
  Eigen::Vector3d result;
  result << camera.project(point), (point.z() - offset_m) / scale;
  return result;
}

Eigen::Vector3d CalibrationError::Lift::position(const Eigen::Vector3d& measured) const {
  const double depth_m = offset_m + scale * measured.z();
  return camera_from_color.inverse() * (depth_m * camera.unproject(measured.head<2>()));
}

CalibrationError::CalibrationError(const RgbdCalibration& calibration) : nominal_(calibration) {
  std::vector<Index> indices;
  std::vector<double> delays_s;
  for (Index i = 0; i < calibration.covariance.rows(); ++i) {
    const double sigma = std::sqrt(calibration.covariance(i, i));
    const auto& name = calibration.parameters[static_cast<std::size_t>(i)];
    RgbdCalibration minus = calibration, plus = calibration;
    if (!(sigma > 0.0) || !shift(minus, name, -sigma)) continue;
    shift(plus, name, sigma);
    indices.push_back(i);
    shifted_.push_back({Lift(minus), Lift(plus)});
    delays_s.push_back(plus.depth_delay_s - calibration.depth_delay_s);
  }
  correlation_ = correlation(calibration.covariance, indices);
  delay_s_ = Eigen::Map<Eigen::RowVectorXd>(delays_s.data(), static_cast<Index>(delays_s.size()));
}

CalibrationError::Sensitivity CalibrationError::sensitivity(
    const Eigen::Vector3d& position_m) const {
  const Eigen::Vector3d measured = nominal_.measurement(position_m);
  Sensitivity result(3, static_cast<Index>(shifted_.size()));
  for (std::size_t i = 0; i < shifted_.size(); ++i)
    result.col(static_cast<Index>(i)) =
        0.5 * (shifted_[i].plus.position(measured) - shifted_[i].minus.position(measured));
  return result;
}

Eigen::Matrix<double, 6, 6> CalibrationError::covariance(
    const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_m_per_s) const {
  const Eigen::Vector3d step_m = velocity_step_s * velocity_m_per_s;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, correlation_.cols());
  jacobian.topRows<3>() = sensitivity(position_m) - velocity_m_per_s * delay_s_;
  jacobian.bottomRows<3>() = (sensitivity(position_m + step_m) - sensitivity(position_m - step_m)) /
                             (2.0 * velocity_step_s);
  return congruence(jacobian, correlation_);
}

}  // namespace touchtrace::label
