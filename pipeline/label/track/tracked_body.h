#pragma once

#include <vector>

#include "pipeline/label/track/owned_cells.h"
#include "pipeline/label/track/target_filter.h"

namespace touchtrace::label {

/// A body of the hand's colour: its motion filter and its surface when it was last visible.
struct TrackedBody {
  TargetFilter filter;
  Eigen::ArrayX3f surface_m = {};  ///< [cells, 3] means of cells when last visible
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  ///< of the surface since then
  double visible_fraction = 0.0;                      ///< exponential average
  double seen_s = 0.0;                                ///< in all
  bool is_visible = false;                            ///< in the last frame

  Eigen::Vector3d expected_m() const { return is_visible ? filter.position_m() : centroid_m; }
  double reach_m() const;
  /// Distance to the surface, moved by `shift_m`.
  double distance_m(const Eigen::Vector3f& position_m) const;
  /// Negative log-likelihood of a place, without the normalisation.
  double misfit(const Place& place) const;

  /// Updates the body with its cells in a frame that is `seconds` after the last one.
  void measure(const OwnedCells& owned, const CellIndices& cells, const Eigen::Vector3d& at_m,
               double seconds);
};

/// Logarithm of the likelihood ratio of two bodies' places and the same places exchanged.
double log_ratio(const TrackedBody& a, const Place& of_a, const TrackedBody& b, const Place& of_b);

}  // namespace touchtrace::label
