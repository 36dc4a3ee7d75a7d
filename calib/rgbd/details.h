#pragma once

#include <nlohmann/json.hpp>

#include "calib/rgbd/calibration.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/depth_fit.h"

namespace touchtrace {

struct CalibrationResult {
  const BoardProblem& problem;
  const RgbdParameters& parameters;
  const RgbdCalibration& calibration;
  const ColorFit& color;
  const DepthNoise& noise;
  const std::vector<bool>& different;  ///< [views]; false for one that repeats another
  double print_gain;                   ///< of choose_print
};

/// RgbdCalibration::details:
///     verdict "GOOD" | "WEAK" | "BAD", advice [..]
///     lens, lenses [{name, bic relative to the best, removed [{parameter, why}..]}..],
///     projection_sigma_px [rows of ImageGrid] (projection_map.h), coverage of the image 0..1,
///     board_print {chosen "ideal" | "free", bic_gain of a free one, sigma_m of a corner's offset
///     in each direction, offsets_m [[x, y, z]..] of the corners; 0 and empty for an ideal one},
///     corner_sigma_px, sigmas {parameter: deviation}, not_told [{parameter, sigma, prior_sigma}]
///     views [{name, used, rms_px, corners_px [[u, v]..], residuals_px [[du, dv]..], depth_rms_m,
///     depth_bias_m}] outlier_views [..], duplicate_views [..], views_without_board [..] depth
///     {samples, sigma_at_1m, exponent, inflation, bias_sigma_at_1m}, null for colour only
///     solving {wall_s, cpu_s}, and of CalibrateSettings::cross_validate held_out {folds,
///     training_rms_px, held_out_rms_px}; these two are added by calibrate().
/// Residuals are measured minus projected; depth_bias_m is the mean of model minus measured.
nlohmann::json calibration_details(const CalibrationResult& result);

}  // namespace touchtrace
