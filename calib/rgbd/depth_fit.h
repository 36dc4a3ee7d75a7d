#pragma once

#include "calib/rgbd/color_fit.h"

namespace touchtrace {

/// The depth camera's noise: sigma(z) = sigma_at_1m * z^exponent for one sample.
struct DepthNoise {
  double sigma_at_1m = 0.01;
  int exponent = 2;        ///< 0, 1 or 2 (2: triangulation)
  double inflation = 1.0;  ///< variance of a mean of samples over that of independent ones

  /// Deviation that makes `inflation` correlated samples weigh as one.
  double effective_sigma_m(double depth_m) const;
};

/// True if at least one view has a depth image.
bool has_depth(const BoardObservations& observations);

/// Side of the blocks of depth_samples [px], so that a view gives about 120.
int depth_block_px(const BoardObservations& observations, const std::vector<bool>& used,
                   const RgbdParameters& parameters);

/// Means of square blocks of depth pixels that lie on the board as posed now, within `extent`
/// (0..1) of the inner corners' rectangle. What is not near the board's plane is left out.
std::vector<DepthSample> depth_samples(const BoardObservations& observations,
                                       const std::vector<bool>& used,
                                       const RgbdParameters& parameters, double extent);

/// Where the ray of a depth pixel meets the flat board: x, y on the board, then the depth in the
/// depth camera's frame [m].
Eigen::Vector3d board_hit(const Eigen::Vector2d& pixel, std::size_t view,
                          const RgbdParameters& parameters);

/// Noise from the residuals; also drops the samples beyond 4 sigma and sets every sample's sigma_m.
/// Until the poses are settled with the depth, what a whole view has in common counts as their
/// error.
DepthNoise weigh_samples(std::vector<DepthSample>& samples, const RgbdParameters& parameters,
                         bool poses_settled);

}  // namespace touchtrace
