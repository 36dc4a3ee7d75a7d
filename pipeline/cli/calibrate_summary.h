#pragma once

#include "calib/rgbd/calibration.h"
#include "calib/rgbd/comparison.h"

namespace touchtrace::cli {

/// Prints camera, lens, depth, board, verdict and advice of a calibration.
void print_summary(const RgbdCalibration& calibration);
/// Prints how two calibrations differ over the image.
void print_comparison(const CalibrationDifference& difference);

}  // namespace touchtrace::cli
