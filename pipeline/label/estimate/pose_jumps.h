#pragma once

#include <Eigen/Core>
#include <vector>

namespace touchtrace::label {

/// Pose of a body in one view.
struct PosedView {
  double time_s;
  Eigen::Vector3d centre_m, sigma_m;   ///< of the body; sigma_m: per axis
  Eigen::Vector3d visible_centroid_m;  ///< of its visible surface
};

/// Variances [m^2] along the axes, one per view in order of time, of a body that jumps between
/// poses which fit about equally well: the mean squared offset to its pose in all views. A jump is
/// a step far beyond the standard deviations that neither the visible surface nor the steps next to
/// it show. Zero without jumps.
std::vector<Eigen::Vector3d> jump_variances(const std::vector<PosedView>& views);

}  // namespace touchtrace::label
