#pragma once

#include <nlohmann/json.hpp>

#include "calib/rgbd/board_models.h"
#include "calib/rgbd/calibration.h"
#include "calib/rgbd/color_fit.h"
#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/view_covariance.h"

namespace touchtrace {

struct DetailsInput {
  const BoardProblem& problem;
  const RgbdParameters& parameters;
  const RgbdCalibration& calibration;
  const ViewCovariance& covariance;
  const ColorFit& color;
  const DepthNoise& noise;
  const std::vector<bool>& different;  ///< [views] false: duplicate of an earlier view
  const BoardModels& boards;
};

/// RgbdCalibration::details. Residuals are measured minus projected.
///     verdict              "GOOD" | "WEAK" | "BAD" (verdict.h)
///     advice               [text..]
///     lens                 name of the chosen lens
///     lenses               [{name, bic relative to the chosen, removed [{parameter, why}..]}..]
///     target_deformation   {chosen "ideal" | "free", bic_gain of "free", sigma_m of an offset in
///                          each direction, offsets_m [[x, y, z]..]}; "ideal": 0 and []
///     board_models         board_models_json()
///     corner_sigma_px      noise of one corner coordinate
///     sigmas               {parameter: standard deviation}
///     independent_sigmas   the same if corners were independent
///     view_inflation       ViewCovariance::inflation
///     projection_sigma_px  [ImageGrid::rows][ImageGrid::columns] (projection_map.h); null: the
///                          lens cannot be inverted there
///     coverage             fraction of the image covered by corners, 0..1
///     not_identifiable     [{parameter, sigma, prior_sigma}..]: sigma above 70 % of the prior's
///     views                [{name, used, rms_px, corners_px [[u, v]..], residuals_px [[u, v]..],
///                          relative_edge_width (BoardView), depth_rms_m, depth_bias_m (mean of
///                          model minus measured)}..]
///     outlier_views, duplicate_views, views_without_board  [name..]
///     skipped_images       [{name, why}..]
///     depth                {samples, sigma_at_1m, exponent, inflation (DepthNoise), delay
///                          "estimated" or the reason why not, bias_sigma_at_1m [m]}; null: colour
///                          only
/// calibrate() adds solving {wall_s, cpu_s} and, with CalibrationOptions::cross_validate, held_out
/// {folds, training_rms_px, held_out_rms_px}.
nlohmann::json calibration_details(const DetailsInput& result);

}  // namespace touchtrace
