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
  /// Whether the stated standard deviations explain the shift, everywhere: some ten parameters
  /// make it, of which a chance in a thousand has a direction beyond five standard deviations.
  bool agrees() const { return rms_sigmas() <= 2.0 && worst_sigmas() <= 5.0; }
};

/// Throws data_error if the image sizes differ or no pixel can be compared.
CalibrationDifference compare(const RgbdCalibration& a, const RgbdCalibration& b);

nlohmann::json difference_json(const CalibrationDifference& difference);

}  // namespace touchtrace
