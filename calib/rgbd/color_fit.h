#pragma once

#include <string>

#include "calib/camera/camera.h"
#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/lens_trials.h"

namespace touchtrace {

/// Calibration of the colour camera alone.
struct ColorFit {
  RgbdParameters parameters;
  std::vector<bool> used;        ///< [views] false: outlier or not usable
  std::vector<int> free_color;   ///< as BoardProblem::free_color
  double corner_sigma_px = 0.0;  ///< noise of one corner coordinate
  std::string chosen;            ///< LensTrial::name
  std::vector<LensTrial> trials;
  bool converged = false;
};

/// Calibrates the colour camera from the views in `usable`.
///
/// Fits robustly, removes outlier views, then chooses the lens among `names` (empty: all) by
/// choose_lens(). The criterion counts independent residuals: corners of a view err together, by
/// view_covariance() of the lens that is best for independent ones.
///
/// "none" and the radial-tangential lenses estimate tangential coefficients under their prior.
/// Fixed at zero, they would rotate every pose, by more than the covariance says.
ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names);

/// Chooses again among lenses of the same ideal projection, given a solution whose corner offsets
/// are free: a board that is not ideal hides, or looks like, lens distortion, and fit_color()
/// compares lenses on the ideal one. The offsets of each lens are its own, under the prior of
/// `problem`. Replaces the trials; the rest of `fit` only if BIC is very strong evidence for
/// another lens, and then returns true.
bool choose_lens_again(const BoardProblem& problem, const RgbdParameters& parameters,
                       ColorFit& fit);

/// Colour camera with the intrinsics of `parameters`.
Camera color_camera(const BoardObservations& observations, const RgbdParameters& parameters);

/// Problem of the used views with the chosen lens, without per-corner deformation.
BoardProblem color_problem(const BoardObservations& observations, const ColorFit& fit);

}  // namespace touchtrace
