#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "calib/rgbd/calibration.h"

namespace touchtrace::label {

/// Propagates a calibration's covariance to labels. This error is the same in a whole recording, so
/// a smoother cannot estimate it: at 1 m a millimetre or two in all positions.
class CalibrationError {
 public:
  /// A calibration without covariance (of another program) gives zero.
  explicit CalibrationError(const RgbdCalibration& calibration);

  /// Covariance [6, 6; m, m/s] of (position, velocity) in the colour camera's frame, of a point
  /// lifted from the depth image. First order, by central differences of one standard deviation.
  Eigen::Matrix<double, 6, 6> covariance(const Eigen::Vector3d& position_m,
                                         const Eigen::Vector3d& velocity_m_per_s) const;

 private:
  /// The parameters that lift a depth pixel to a position and time.
  struct Lift {
    explicit Lift(const RgbdCalibration& calibration);
    /// (u, v [px], measured depth [m]) of a position.
    Eigen::Vector3d measurement(const Eigen::Vector3d& position_m) const;
    /// Inverse of measurement().
    Eigen::Vector3d position(const Eigen::Vector3d& measurement) const;

    Camera camera;
    Eigen::Isometry3d camera_from_color;
    double scale, offset_m, delay_s;
  };
  /// The calibration with one parameter changed by one standard deviation either way.
  struct Shifted {
    Lift minus, plus;
  };
  using Sensitivity = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  /// Change of a position [m] per standard deviation of each parameter.
  Sensitivity sensitivity(const Eigen::Vector3d& position_m) const;

  Lift nominal_;
  std::vector<Shifted> shifted_;
  Eigen::MatrixXd correlation_;  ///< of the parameters
  Eigen::RowVectorXd delay_s_;   ///< change of the depth delay per standard deviation of each
};

}  // namespace touchtrace::label
