#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "engine/base/random.h"
#include "pipeline/label/states/calibration_error.h"

namespace touchtrace::label {
namespace {

using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const std::vector<std::string> names{"depth.fx",
                                     "depth.cx",
                                     "depth_from_color.rx",
                                     "depth_from_color.rz",
                                     "depth_from_color.tx",
                                     "depth_from_color.ty",
                                     "depth.scale",
                                     "depth.offset",
                                     "depth.delay",
                                     "color.fx"};
const Vector3d position_m(0.2, -0.1, 1.1), velocity_m_per_s(0.8, -2.0, 0.5);

/// Realistic standard deviations; scale and offset are anticorrelated.
Eigen::MatrixXd covariance() {
  Eigen::VectorXd sigma(names.size());
  sigma << 1.5, 0.7, 4e-4, 4e-4, 1e-3, 1e-3, 7e-4, 2.5e-3, 1e-3, 0.4;
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(sigma.size(), sigma.size());
  correlation(6, 7) = correlation(7, 6) = -0.9;
  correlation(1, 4) = correlation(4, 1) = 0.6;
  return sigma.asDiagonal() * correlation * sigma.asDiagonal();
}

RgbdCalibration calibration() {
  RgbdCalibration c;
  c.color.width = 640, c.color.height = 480;
  c.color.fx = c.color.fy = 604.0, c.color.cx = 319.5, c.color.cy = 239.5;
  c.depth = c.color;
  c.depth->fx = 608.0, c.depth->fy = 607.0;
  c.depth_from_color =
      Eigen::Translation3d(0.025, 0.001, -0.002) * Eigen::AngleAxisd(0.006, Vector3d::UnitZ());
  c.depth_scale = 0.996, c.depth_offset_m = 0.005;
  c.parameters = names;
  c.covariance = covariance();
  return c;
}

/// Position at `time_s`, by a calibration with parameter errors `off`, of a point that is at
/// `position_m` at time 0.
Vector3d position_with(const RgbdCalibration& c, const Eigen::VectorXd& off, double time_s) {
  const Vector3d point = c.depth_from_color * (position_m + time_s * velocity_m_per_s);
  const Vector3d ray(point.x() / point.z() * c.depth->fx / (c.depth->fx + off[0]) -
                         off[1] / (c.depth->fx + off[0]),
                     point.y() / point.z(), 1.0);
  const double measured_m = (point.z() - c.depth_offset_m) / c.depth_scale;
  const double depth_m = c.depth_offset_m + off[7] + (c.depth_scale + off[6]) * measured_m;
  Eigen::Isometry3d depth_from_color = c.depth_from_color;
  depth_from_color.linear() = Eigen::AngleAxisd(Vector3d(off[2], 0.0, off[3]).norm(),
                                                Vector3d(off[2], 0.0, off[3]).normalized()) *
                              depth_from_color.linear();
  depth_from_color.translation() += Vector3d(off[4], off[5], 0.0);
  return depth_from_color.inverse() * (depth_m * ray) - off[8] * velocity_m_per_s;
}

TEST(CalibrationError, CovarianceMatchesAMonteCarlo) {
  const auto c = calibration();
  const Eigen::MatrixXd root = c.covariance.llt().matrixL();
  constexpr int draws = 20000;
  constexpr double step_s = 0.01;
  RandomStream random(1, "calibrations");
  Matrix6 drawn = Matrix6::Zero();
  for (int i = 0; i < draws; ++i) {
    const Eigen::VectorXd off =
        root * Eigen::VectorXd::NullaryExpr(root.cols(), [&] { return random.normal(); });
    Vector6 error;
    error << position_with(c, off, 0.0) - position_m,
        (position_with(c, off, step_s) - position_with(c, off, -step_s)) / (2.0 * step_s) -
            velocity_m_per_s;
    drawn += error * error.transpose() / draws;
  }
  const Matrix6 covariance = CalibrationError(c).covariance(position_m, velocity_m_per_s);
  // A variance of n draws has a relative standard deviation of sqrt(2 / n) = 1 %; 4 of them.
  const Matrix6 unit = drawn.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  EXPECT_LT((unit * (covariance - drawn) * unit).cwiseAbs().maxCoeff(), 0.04);
}

TEST(CalibrationError, IsZeroWithoutACovariance) {
  auto c = calibration();
  c.parameters.clear(), c.covariance.resize(0, 0);
  EXPECT_TRUE(CalibrationError(c).covariance(position_m, velocity_m_per_s).isZero(0.0));
}

TEST(CalibrationError, SupportsAColorOnlyCalibration) {
  auto c = calibration();
  c.depth.reset(), c.depth_from_color.setIdentity();
  c.parameters = {"color.fx"}, c.covariance = Eigen::MatrixXd::Constant(1, 1, 0.25);
  const Matrix6 covariance = CalibrationError(c).covariance(position_m, velocity_m_per_s);
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), position_m.x() * 0.5 / c.color.fx, 1e-8);
  EXPECT_NEAR(covariance(2, 2), 0.0, 1e-18);
}

}  // namespace
}  // namespace touchtrace::label
