#pragma once

#include <string>

#include "calib/camera/camera.h"
#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Lower bound of the estimated corner noise: weights of noise-free data stay finite.
inline constexpr double min_corner_sigma_px = 1e-6;
/// Differences of BIC that are positive and very strong evidence (Kass and Raftery, JASA 1995).
inline constexpr double bic_positive_evidence = 2.0, bic_very_strong_evidence = 10.0;

/// Fit of one candidate lens.
struct LensTrial {
  std::string name;  ///< lens_name(); "none": no radial coefficients
  double bic = 0.0;  ///< relative to the chosen lens; infinite if it did not converge
  /// Unobservable coefficients, fixed at 0, and the reason.
  std::vector<std::pair<std::string, std::string>> removed;
};

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
/// Fits robustly, removes outlier views, then chooses the lens among `names` (empty: all) by the
/// Bayesian information criterion. A later lens must be better by 2, one of the other ideal
/// projection (perspective, fisheye) by 10, unless it has fewer coefficients and the first choice
/// leaves much of the image unknown. The criterion counts independent residuals: corners of a view
/// err together, by view_covariance() of the lens that is best for independent ones. Unobservable
/// coefficients are removed, the last first, and the remaining ones fitted again.
///
/// "none" and the radial-tangential lenses estimate tangential coefficients under their prior.
/// Fixed at zero, they would rotate every pose, by more than the covariance says.
ColorFit fit_color(const BoardObservations& observations, const std::vector<bool>& usable,
                   const std::vector<std::string>& names);

/// Colour camera with the intrinsics of `parameters`.
Camera color_camera(const BoardObservations& observations, const RgbdParameters& parameters);

/// Problem of the used views with the chosen lens, without per-corner deformation.
BoardProblem color_problem(const BoardObservations& observations, const ColorFit& fit);

/// Twice the number of corners in the used views.
double num_corner_coordinates(const BoardObservations& observations, const std::vector<bool>& used);

/// Noise of one corner coordinate [px], from the residuals of the used views and the degrees of
/// freedom without per-corner deformation.
double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters);

/// RMS length of the residuals [px], as OpenCV reports it. 0 if there are none.
double rms(const std::vector<Eigen::Vector2d>& residuals);

/// rms() over all corners of the used views.
double rms_of_used_views(const BoardObservations& observations, const std::vector<bool>& used,
                         const RgbdParameters& parameters);

}  // namespace touchtrace
