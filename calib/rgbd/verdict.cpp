#include "calib/rgbd/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace {
namespace {

/// Up to `good` is GOOD, up to `weak` WEAK, beyond it (or not finite) BAD.
void apply(Verdict& verdict, double value, double good, double weak, const std::string& advice) {
  if (value <= good) return;
  verdict.grade = std::max(verdict.grade, value <= weak ? Grade::weak : Grade::bad);
  verdict.advice.push_back(advice);
}

Eigen::Index index_of(const RgbdCalibration& c, const std::string& parameter) {
  const auto found = std::ranges::find(c.parameters, parameter);
  return found == c.parameters.end() ? -1 : found - c.parameters.begin();
}

void judge_color(Verdict& verdict, const RgbdCalibration& c, int used_views) {
  apply(verdict, c.rms_px, 0.5, 1.5,
        fmt::format(
            "corners are off by {:.2f} px RMS: use a flat board, sharp images and a still board",
            c.rms_px));
  apply(verdict, -used_views, -8, -4,
        fmt::format("only {} views: show the board in 10 to 20 poses", used_views));
  const double focal_px = std::max(deviation(c, "color.fx"), deviation(c, "color.fy"));
  apply(verdict, focal_px / c.color.fx, 0.005, 0.02,
        fmt::format(
            "the focal length is known to {:.1f} px only: tilt the board more, by 30 to 45 degrees "
            "in different directions",
            focal_px));
  const double centre_px = std::max(deviation(c, "color.cx"), deviation(c, "color.cy"));
  apply(verdict, centre_px / c.color.width, 0.005, 0.02,
        fmt::format(
            "the principal point is known to {:.1f} px only: bring the board to all corners of the "
            "image, turned by 90 degrees in some views",
            centre_px));
}

void judge_depth(Verdict& verdict, const RgbdCalibration& c) {
  const double bias_mm = 1e3 * depth_bias_deviation_m(c, 1.0);
  apply(verdict, bias_mm, 5.0, 20.0,
        fmt::format("depth at 1 m is known to {:.1f} mm only: show the board from 0.4 to 1.5 m",
                    bias_mm));
  const double pose_mm =
      1e3 * std::max({deviation(c, "depth_from_color.tx"), deviation(c, "depth_from_color.ty"),
                      deviation(c, "depth_from_color.tz")});
  apply(verdict, pose_mm, 5.0, 25.0,
        fmt::format("the depth camera's place is known to {:.1f} mm only: tilt the board more, "
                    "near the camera",
                    pose_mm));
}

}  // namespace

const char* grade_name(Grade grade) {
  constexpr const char* names[] = {"GOOD", "WEAK", "BAD"};
  return names[static_cast<int>(grade)];
}

double deviation(const RgbdCalibration& c, const std::string& parameter) {
  const auto i = index_of(c, parameter);
  return i < 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(c.covariance(i, i));
}

double depth_bias_deviation_m(const RgbdCalibration& c, double depth_m) {
  const auto scale = index_of(c, "depth.scale"), offset = index_of(c, "depth.offset");
  if (scale < 0 || offset < 0) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(c.covariance(offset, offset) + 2.0 * depth_m * c.covariance(scale, offset) +
                   depth_m * depth_m * c.covariance(scale, scale));
}

Verdict judge(const RgbdCalibration& calibration, int used_views) {
  Verdict verdict;
  judge_color(verdict, calibration, used_views);
  if (calibration.depth) judge_depth(verdict, calibration);
  return verdict;
}

}  // namespace touchtrace
