#pragma once

#include <limits>
#include <vector>

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/lens_choice.h"

namespace touchtrace {

/// Fit of the colour camera with one lens, robust against outlier views.
struct RobustFit {
  RgbdParameters parameters;
  std::vector<bool> used;  ///< [views] without outliers
  double sigma_px = 1.0;   ///< noise of one corner coordinate
  /// RMS of the median view; infinite: not converged.
  double typical_rms_px = std::numeric_limits<double>::infinity();
};

/// One robust fit for each ideal projection.
struct RobustFits {
  RobustFit perspective, equidistant;

  const RobustFit& better() const;
  /// Start for a fit of a lens: the fit with its own ideal projection or, if that is much worse,
  /// the lens that is nearest to the other one.
  RgbdParameters start_of(const LensChoice& choice, const BoardObservations& observations) const;
};

/// Alternates between solving and updating noise and outlier views: those with more than three
/// times the RMS of the median view.
RobustFits fit_robustly(const BoardObservations& observations, const std::vector<bool>& usable);

/// RMS of an outlier view over that of the median view.
inline constexpr double outlier_ratio = 3.0;
/// An RMS that is larger by this factor is much worse.
inline constexpr double much_worse_ratio = 2.0;

}  // namespace touchtrace
