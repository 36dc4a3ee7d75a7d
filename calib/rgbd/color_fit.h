#pragma once

#include <string>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Of data without noise, where weights lose their meaning.
inline constexpr double smallest_corner_sigma_px = 1e-6;
/// How much BIC must speak for something (Kass and Raftery, JASA 1995).
inline constexpr double worth_a_mention = 2.0, very_strong = 10.0;

/// One lens tried on the corners.
struct LensTrial {
  std::string name;  ///< lens_name(); "none": no radial coefficients
  double bic = 0.0;  ///< relative to the best; infinite if nothing converged
  /// Coefficients that the data cannot tell, with the reason; they stay 0.
  std::vector<std::pair<std::string, std::string>> removed;
};

/// The colour camera alone.
struct ColorFit {
  RgbdParameters parameters;
  std::vector<bool> used;        ///< [views]; outlier views are left out
  std::vector<int> free_color;   ///< as BoardProblem::free_color
  double corner_sigma_px = 0.0;  ///< noise of a corner's coordinate
  std::string chosen;            ///< name of a trial
  std::vector<LensTrial> trials;
  bool converged = false;
};

/// Robust fit of the views in `usable`, outlier views out, then the lens of `names` (all if empty)
/// that the Bayesian information criterion prefers; a later one must be better by 2, one of the
/// other kind (perspective, fisheye) by 10. Coefficients
/// that the data do not tell are removed from the last on and the rest fitted anew.
///
/// "none" and the radial-tangential lenses keep tangential coefficients free under their prior: set
/// to zero they would turn every pose, with a covariance that does not know it.
ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names);

/// The problem of the used views once the lens is chosen; for the board as it should be.
BoardProblem color_problem(const BoardObservations& observations, const ColorFit& fit);

/// Two for each corner of the used views.
double number_of_coordinates(const BoardObservations& observations, const std::vector<bool>& used);

/// Noise of a corner's coordinate [px] from the residuals of the used views and the degrees of
/// freedom, on an ideal board.
double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters);

/// RMS over corners of the residual's length [px], as OpenCV reports it; 0 without residuals.
double rms(const std::vector<Eigen::Vector2d>& residuals);

/// That over the corners of the used views.
double rms_of_used(const BoardObservations& observations, const std::vector<bool>& used,
                   const RgbdParameters& parameters);

}  // namespace touchtrace
