#pragma once

#include <string>
#include <vector>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

enum class Grade { good, weak, bad };

struct Verdict {
  Grade grade = Grade::good;
  std::vector<std::string> advice;  ///< what is lacking and what to do about it; empty when good
};

const char* grade_name(Grade grade);  ///< GOOD, WEAK, BAD

/// Judges by residuals, number of views, and the deviations of focal length, principal point and
/// depth.
Verdict judge(const RgbdCalibration& calibration, int used_views);

/// Standard deviation of a named parameter; NaN if the covariance does not have it.
double deviation(const RgbdCalibration& calibration, const std::string& parameter);

/// Standard deviation [m] of the corrected depth of a surface that measures `depth_m`.
double depth_bias_deviation_m(const RgbdCalibration& calibration, double depth_m);

}  // namespace touchtrace
