#pragma once

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Per-corner deformation of the calibration target: offsets of its corners, distributed as
/// N(0, sigma_m^2) in each direction.
struct TargetDeformation {
  double sigma_m = 0.0;          ///< 0: none
  double corner_sigma_px = 0.0;  ///< remaining noise of one corner coordinate
  double bic_gain = 0.0;         ///< BIC of the ideal board minus that of this one
};

/// Estimates the variance of the offsets by restricted maximum likelihood (Patterson and Thompson,
/// Biometrika 1971) of the problem linearised at `parameters`. Camera, poses, warp and offsets are
/// marginalised. The variance is one parameter for all offsets, so that BIC does not reward their
/// number.
TargetDeformation estimate_deformation(const BoardProblem& problem,
                                       const RgbdParameters& parameters);

/// Frees the corner offsets of a solved problem and solves it again, if BIC is very strong evidence
/// for them (calibration with an imperfect target: Strobl and Hirzinger, ICCV workshops 2011). Else
/// `problem` and `parameters` are unchanged. Returns TargetDeformation::bic_gain.
double fit_target_deformation(BoardProblem& problem, RgbdParameters& parameters);

/// Warp and corner offsets of a calibration; all other members keep their defaults.
RgbdParameters board_parameters(const RgbdCalibration& calibration);

/// Noise of one corner coordinate [px] at the solution of the problem.
double estimate_corner_sigma_px(const BoardProblem& problem, const RgbdParameters& parameters);

}  // namespace touchtrace
