#pragma once

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Difference of two calibrations of one colour camera, over ImageGrid. A rotation between the two
/// is fitted and does not count, as in mrcal-show-projection-diff: poses of boards absorb it.
struct CalibrationDifference {
  Eigen::MatrixXd
      shift_px;  ///< [rows, columns] far points move by this; NaN where one cannot project
  Eigen::MatrixXd sigma_px;  ///< [rows, columns] root mean square of the shift if both are right
  double focal_px = 0.0;

  double median_px() const;
  double worst_px() const;
  /// Root mean square of shift_px over sigma_px: 1 on average if both covariances are right.
  double rms_sigmas() const;
  /// Largest shift_px over sigma_px.
  double worst_sigmas() const;
  /// Whether the stated standard deviations explain the shift, on average and everywhere. A lens
  /// has up to nine parameters besides a rotation: if all errors are normal, the largest deviation
  /// in any direction is above five in up to 0.3 % of cases (chi-square above 25).
  bool agrees() const { return rms_sigmas() <= 2.0 && worst_sigmas() <= 5.0; }
};

/// Throws data_error if the image sizes differ or no pixel can be compared.
CalibrationDifference compare(const RgbdCalibration& a, const RgbdCalibration& b);

nlohmann::json difference_json(const CalibrationDifference& difference);

}  // namespace touchtrace
