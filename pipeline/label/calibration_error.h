#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "calib/rgbd/calibration.h"

namespace touchtrace::label {

/// What a calibration's own uncertainty makes of a label. It is the same for a whole recording, so
/// no smoother sees it: at a metre a millimetre or two that all positions have in common.
class CalibrationError {
 public:
  /// Of a calibration without a covariance (another program's): none.
  explicit CalibrationError(const RgbdCalibration& calibration);

  /// Covariance of position and velocity in the colour camera's frame [6, 6; m, m/s], for what was
  /// lifted there from the depth image. First order.
  Eigen::Matrix<double, 6, 6> covariance(const Eigen::Vector3d& position_m,
                                         const Eigen::Vector3d& velocity_m_per_s) const;

 private:
  /// The part of a calibration that gives what the depth camera sees its place and time.
  struct Lift {
    explicit Lift(const RgbdCalibration& calibration);
    Eigen::Vector3d seen(const Eigen::Vector3d& position_m) const;
    Eigen::Vector3d place(const Eigen::Vector3d& pixel_and_measured_depth) const;

    Camera camera;
    Eigen::Isometry3d camera_from_color;
    double scale, offset_m, delay_s;
  };
  /// Calibrations a deviation of one parameter to either side.
  struct Shifted {
    Lift less, more;
  };
  using Change = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  /// Of a place, a deviation of each parameter [m].
  Change change_of(const Eigen::Vector3d& position_m) const;

  Lift here_;
  std::vector<Shifted> shifted_;
  Eigen::MatrixXd correlation_;  ///< of the parameters
  Eigen::RowVectorXd delay_s_;   ///< a deviation of each parameter
};

}  // namespace touchtrace::label
