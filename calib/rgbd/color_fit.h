#pragma once

#include <map>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// The colour camera alone.
struct ColorFit {
  RgbdParameters parameters;
  std::vector<bool> used;        ///< [views]; outlier views are left out
  std::vector<int> free_color;   ///< as BoardProblem::free_color
  double corner_sigma_px = 0.0;  ///< noise of a corner's coordinate
  int radial_coefficients = 0;   ///< 0, 2: k1 k2, 3: and k3
  std::map<int, double> bic;     ///< by number of radial coefficients, relative to the best
  bool converged = false;
};

/// Robust fit, outlier views out, then the best number of radial coefficients of `radial_choices`
/// (0, 2 or 3) by the Bayesian information criterion. The tangential coefficients stay free under
/// their prior: set to zero they would turn every pose, with a covariance that does not know it.
ColorFit fit_color(const BoardObservations& observations, const Prior& prior,
                   const std::vector<int>& radial_choices);

/// Noise of a corner's coordinate [px] from the residuals of the used views and the degrees of
/// freedom.
double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters);

/// RMS over corners of the residual's length [px], as OpenCV reports it; 0 without residuals.
double rms(const std::vector<Eigen::Vector2d>& residuals);

}  // namespace touchtrace
