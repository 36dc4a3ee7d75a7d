#include "calib/rgbd/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/rgbd/projection_map.h"

namespace touchtrace {
namespace {

constexpr double min_aspect_sigmas = 4.0, max_model_sigmas = 3.0;

Eigen::Index index_of(const RgbdCalibration& c, const std::string& parameter) {
  const auto found = std::ranges::find(c.parameters, parameter);
  return found == c.parameters.end() ? -1 : found - c.parameters.begin();
}

void assess_color(Verdict& verdict, const RgbdCalibration& c, int used_views) {
  apply_limits(verdict, c.rms_px, 0.5, 1.5,
               fmt::format("the reprojection error is {:.2f} px RMS: use a flat board, sharp "
                           "images and a still board",
                           c.rms_px));
  apply_limits(verdict, -used_views, -8, -4,
               fmt::format("only {} views: show the board in 10 to 20 poses", used_views));
  const double focal_px = std::max(parameter_sigma(c, "color.fx"), parameter_sigma(c, "color.fy"));
  apply_limits(
      verdict, focal_px / c.color.fx, 0.005, 0.02,
      fmt::format(
          "the standard deviation of the focal length is {:.1f} px: tilt the board more, by 30 to "
          "45 degrees in different directions",
          focal_px));
  const double centre_px = std::max(parameter_sigma(c, "color.cx"), parameter_sigma(c, "color.cy"));
  apply_limits(verdict, centre_px / c.color.width, 0.005, 0.02,
               fmt::format("the standard deviation of the principal point is {:.1f} px: show the "
                           "board in all corners "
                           "of the image, rotated by 90 degrees in some views",
                           centre_px));
}

/// Pixels of a sensor are square: fx and fy differ only if the board or the images are distorted.
void assess_aspect(Verdict& verdict, const RgbdCalibration& c) {
  const auto x = index_of(c, "color.fx"), y = index_of(c, "color.fy");
  if (x < 0 || y < 0) return;
  const double difference = c.color.fy / c.color.fx - 1.0;
  const double sigma =
      std::sqrt(c.covariance(x, x) + c.covariance(y, y) - 2.0 * c.covariance(x, y)) / c.color.fx;
  if (std::abs(difference) < min_aspect_sigmas * sigma) return;
  apply_limits(verdict, std::abs(difference), 0.01, 0.1,
               fmt::format("fy differs from fx by {:+.1f} %, {:.0f} standard deviations: measure "
                           "whether the board's squares are square, and use images as the camera "
                           "gives them, not resized",
                           1e2 * difference, std::abs(difference) / sigma));
}

/// Corners of neighbouring edges disturb each other where edges are wide.
void assess_sharpness(Verdict& verdict, double relative_edge_width) {
  if (std::isnan(relative_edge_width)) return;
  apply_limits(
      verdict, relative_edge_width, 0.25, std::numeric_limits<double>::infinity(),
      fmt::format("the images are blurred: edges are as wide as {:.0f} % of a square. Focus "
                  "on the board, hold it still, use more light",
                  1e2 * relative_edge_width));
}

/// Views that contradict each other: `details.views` lists them.
void assess_agreement(Verdict& verdict, double view_inflation) {
  apply_limits(verdict, view_inflation, 4.0, std::numeric_limits<double>::infinity(),
               fmt::format("the views contradict each other: they scatter {:.1f} times as much as "
                           "their corners do. Use images of one camera with fixed focus and zoom, "
                           "without stabilisation, and a stiff board at rest",
                           view_inflation));
}

/// Corners off a smooth surface can look like another focal length.
void assess_flatness(Verdict& verdict, double focal_spread) {
  apply_limits(verdict, focal_spread, 0.01, 0.05,
               fmt::format("the board is not flat: fx changes by {:.1f} % if its corners are free "
                           "to lie off a smooth surface. Use a stiff, flat board",
                           1e2 * focal_spread));
}

/// The choice of the board's model may move the intrinsics by more than they are uncertain.
void assess_board_model(Verdict& verdict, const RgbdCalibration& c,
                        const Eigen::Vector4d& change_px) {
  constexpr std::array names{"fx", "fy", "cx", "cy"};
  std::string moved;
  double largest = 0.0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double change = change_px[static_cast<Eigen::Index>(i)],
                 sigmas = std::abs(change) / parameter_sigma(c, fmt::format("color.{}", names[i]));
    if (!(sigmas > max_model_sigmas)) continue;
    largest = std::max(largest, std::abs(change) / (i < 2 ? c.color.fx : c.color.width));
    moved += fmt::format("{}{} by {:+.1f} px ({:.1f} standard deviations)",
                         moved.empty() ? "" : ", ", names[i], change, sigmas);
  }
  apply_limits(verdict, largest, 0.005, std::numeric_limits<double>::infinity(),
               fmt::format("free corners of the board move {}, which the standard deviations do "
                           "not contain: compare with --no-target-deformation, use a stiff, flat "
                           "board",
                           moved));
}

void assess_image(Verdict& verdict, const RgbdCalibration& c) {
  const double sigma_px = projection_sigma_quantile_px(c, judged_image_fraction);
  const std::string known = std::isfinite(sigma_px)
                                ? fmt::format("is known to {:.1f} px or worse", sigma_px)
                                : "is unknown, because the lens cannot be inverted there";
  apply_limits(
      verdict, sigma_px / c.color.width, good_projection_sigma, weak_projection_sigma,
      fmt::format("a fifth of the image {}: show the board there, or try another --lens", known));
}

void assess_depth(Verdict& verdict, const RgbdCalibration& c) {
  const double bias_mm = 1e3 * depth_bias_sigma_m(c, 1.0);
  apply_limits(
      verdict, bias_mm, 5.0, 20.0,
      fmt::format(
          "the standard deviation of depth at 1 m is {:.1f} mm: show the board from 0.4 to 1.5 m",
          bias_mm));
  const double pose_mm = 1e3 * std::max({parameter_sigma(c, "depth_from_color.tx"),
                                         parameter_sigma(c, "depth_from_color.ty"),
                                         parameter_sigma(c, "depth_from_color.tz")});
  apply_limits(
      verdict, pose_mm, 5.0, 25.0,
      fmt::format("the standard deviation of the depth camera's position is {:.1f} mm: tilt the "
                  "board more, near the camera",
                  pose_mm));
}

}  // namespace

void apply_limits(Verdict& verdict, double value, double good, double weak,
                  const std::string& advice) {
  if (value <= good) return;
  verdict.grade = std::max(verdict.grade, value <= weak ? Grade::weak : Grade::bad);
  verdict.advice.push_back(advice);
}

const char* grade_name(Grade grade) {
  constexpr const char* names[] = {"GOOD", "WEAK", "BAD"};
  return names[static_cast<int>(grade)];
}

double parameter_sigma(const RgbdCalibration& c, const std::string& parameter) {
  const auto i = index_of(c, parameter);
  return i < 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(c.covariance(i, i));
}

double depth_bias_sigma_m(const RgbdCalibration& c, double depth_m) {
  const auto scale = index_of(c, "depth.scale"), offset = index_of(c, "depth.offset");
  if (scale < 0 || offset < 0) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(c.covariance(offset, offset) + 2.0 * depth_m * c.covariance(scale, offset) +
                   depth_m * depth_m * c.covariance(scale, scale));
}

Verdict assess_calibration(const RgbdCalibration& calibration, const ViewQuality& views) {
  Verdict verdict;
  assess_color(verdict, calibration, views.used);
  assess_aspect(verdict, calibration);
  assess_sharpness(verdict, views.relative_edge_width);
  assess_agreement(verdict, views.inflation);
  assess_flatness(verdict, std::abs(views.board_model_change_px[0]) / calibration.color.fx);
  assess_board_model(verdict, calibration, views.board_model_change_px);
  assess_image(verdict, calibration);
  if (calibration.depth) assess_depth(verdict, calibration);
  return verdict;
}

}  // namespace touchtrace
