#include "pipeline/label/calibration_error.h"

#include <algorithm>
#include <cmath>

namespace touchtrace::label {
namespace {

using Eigen::Index;

constexpr double velocity_step_s = 0.01;

/// What the depth camera is of: a calibration in colour alone knows but one camera.
Camera& depth_camera(RgbdCalibration& calibration) {
  return calibration.depth ? *calibration.depth : calibration.color;
}

/// Moves the axis of a place or a turn that a name ends with.
void move_pose(Eigen::Isometry3d& pose, const std::string& name, double by) {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(name.back() - 'x');
  if (name[name.size() - 2] == 't')
    pose.translation() += by * axis;
  else
    pose.linear() = Eigen::AngleAxisd(by, axis) * pose.linear();
}

/// False where a label does not depend on the parameter.
bool shift(RgbdCalibration& calibration, const std::string& name, double by) {
  auto& camera = depth_camera(calibration);
  const auto intrinsics = intrinsic_names(camera.lens);
  const std::string camera_name = calibration.depth ? "depth." : "color.";
  const auto intrinsic =
      std::ranges::find_if(intrinsics, [&](const auto& end) { return name == camera_name + end; });
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

Eigen::MatrixXd correlation(const Eigen::MatrixXd& covariance, const std::vector<Index>& of) {
  const Eigen::MatrixXd part = covariance(of, of);
  const Eigen::VectorXd inverse = part.diagonal().cwiseSqrt().cwiseInverse();
  return inverse.asDiagonal() * part * inverse.asDiagonal();
}

}  // namespace

CalibrationError::Lift::Lift(const RgbdCalibration& c)
    : camera(c.depth ? *c.depth : c.color),
      camera_from_color(c.depth_from_color),
      scale(c.depth_scale),
      offset_m(c.depth_offset_m),
      delay_s(c.depth_delay_s) {}

Eigen::Vector3d CalibrationError::Lift::seen(const Eigen::Vector3d& position_m) const {
  const Eigen::Vector3d point = camera_from_color * position_m;
  Eigen::Vector3d pixel_and_measured_depth;
  pixel_and_measured_depth << camera.project(point), (point.z() - offset_m) / scale;
  return pixel_and_measured_depth;
}

Eigen::Vector3d CalibrationError::Lift::place(const Eigen::Vector3d& seen) const {
  const double depth_m = offset_m + scale * seen.z();
  return camera_from_color.inverse() * (depth_m * camera.unproject(seen.head<2>()));
}

CalibrationError::CalibrationError(const RgbdCalibration& calibration) : here_(calibration) {
  std::vector<Index> of;
  std::vector<double> delays_s;
  for (Index i = 0; i < calibration.covariance.rows(); ++i) {
    const double deviation = std::sqrt(calibration.covariance(i, i));
    const auto& name = calibration.parameters[static_cast<std::size_t>(i)];
    RgbdCalibration less = calibration, more = calibration;
    if (!(deviation > 0.0) || !shift(less, name, -deviation)) continue;
    shift(more, name, deviation);
    of.push_back(i);
    shifted_.push_back({Lift(less), Lift(more)});
    delays_s.push_back(more.depth_delay_s - calibration.depth_delay_s);
  }
  correlation_ = correlation(calibration.covariance, of);
  delay_s_ = Eigen::Map<Eigen::RowVectorXd>(delays_s.data(), static_cast<Index>(delays_s.size()));
}

CalibrationError::Change CalibrationError::change_of(const Eigen::Vector3d& position_m) const {
  const Eigen::Vector3d seen = here_.seen(position_m);
  Change change(3, static_cast<Index>(shifted_.size()));
  for (std::size_t i = 0; i < shifted_.size(); ++i)
    change.col(static_cast<Index>(i)) =
        0.5 * (shifted_[i].more.place(seen) - shifted_[i].less.place(seen));
  return change;
}

Eigen::Matrix<double, 6, 6> CalibrationError::covariance(
    const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_m_per_s) const {
  const Eigen::Vector3d step_m = velocity_step_s * velocity_m_per_s;
  Eigen::Matrix<double, 6, Eigen::Dynamic> change(6, correlation_.cols());
  change.topRows<3>() = change_of(position_m) - velocity_m_per_s * delay_s_;
  change.bottomRows<3>() =
      (change_of(position_m + step_m) - change_of(position_m - step_m)) / (2.0 * velocity_step_s);
  return change * correlation_ * change.transpose();
}

}  // namespace touchtrace::label
