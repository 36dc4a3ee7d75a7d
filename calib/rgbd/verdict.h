#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Fraction of the image in which the projection has to be known.
inline constexpr double judged_image_fraction = 0.8;
/// Largest standard deviation of the projection in that fraction of the image, over the image
/// width.
inline constexpr double good_projection_sigma = 0.0025, weak_projection_sigma = 0.02;

enum class Grade { good, weak, bad };

struct Verdict {
  Grade grade = Grade::good;
  std::vector<std::string> advice;  ///< one entry per criterion that is not good
};

/// Properties of the views that a verdict uses in addition to the calibration.
struct ViewQuality {
  int used = 0;            ///< number of views
  double inflation = 1.0;  ///< ViewCovariance::inflation
  double relative_edge_width = std::numeric_limits<double>::quiet_NaN();  ///< median; NaN: unknown
  Eigen::Vector4d board_model_change_px = Eigen::Vector4d::Zero();  ///< BoardModels::change_px()
};

const char* grade_name(Grade grade);  ///< GOOD, WEAK, BAD

/// Grades a calibration by its worst criterion; a value that is not finite is BAD. The limits of
/// GOOD and WEAK:
///  - colour reprojection RMS 0.5, 1.5 px; at least 8, 4 views
///  - standard deviation of fx, fy: 0.5, 2 % of fx; of cx, cy: 0.5, 2 % of the image width
///  - median BoardView::relative_edge_width: 0.25, none; public sets have 0.03 to 0.13
///  - ViewCovariance::inflation, part of the standard deviations: 4, none; 16 of 20 public sets
///    have less
///  - BoardModels::change_px(), which the standard deviations do not contain: of fx 1, 5 %; 9 of 11
///    public sets of boards have less than 1 %, bent sheets of paper up to 29 %. Where it
///    exceeds 3 standard deviations: of fx, fy 0.5 % of fx, of cx, cy of the width, none
///  - |fy / fx - 1|, where it exceeds 4 standard deviations: 1, 10 %
///  - projection_sigma_px() over the best four fifths of the image, without parts that are black in
///    all images: 0.25, 2 % of its width
///  - standard deviation of corrected depth at 1 m: 5, 20 mm; of the depth camera's position: 5,
///    25 mm
Verdict assess_calibration(const RgbdCalibration& calibration, const ViewQuality& views);

/// Lowers the grade to WEAK if `value` > `good`, to BAD if `value` > `weak` or NaN.
void apply_limits(Verdict& verdict, double value, double good, double weak,
                  const std::string& advice);

/// Standard deviation of a parameter; NaN if it was not estimated.
double parameter_sigma(const RgbdCalibration& calibration, const std::string& parameter);

/// Standard deviation [m] of the corrected depth of a surface measured at `depth_m`.
double depth_bias_sigma_m(const RgbdCalibration& calibration, double depth_m);

}  // namespace touchtrace
