#pragma once

#include "calib/rgbd/color_fit.h"

namespace touchtrace {

/// Noise of one depth sample: sigma(z) = sigma_at_1m * z^exponent [m].
struct DepthNoise {
  double sigma_at_1m = 0.01;
  int exponent = 2;        ///< 0, 1, or 2 as triangulation has it
  double inflation = 1.0;  ///< variance of a mean of samples over that of independent ones

  /// sigma(z) * sqrt(inflation): a sum over correlated samples then has the right weight.
  double effective_sigma_m(double depth_m) const;
};

/// True if at least one view has a depth image.
bool has_depth(const BoardObservations& observations);

/// Side [px] of the blocks of depth_samples() that gives about 120 samples a view.
int depth_block_px(const BoardObservations& observations, const std::vector<bool>& used,
                   const RgbdParameters& parameters);

/// Returns means over square blocks of depth pixels on the board, for the poses in `parameters`.
/// `extent`: fraction of the sides of the inner corners' rectangle that is used, 0..1. Pixels more
/// than 15 % from the board's plane are ignored.
std::vector<DepthSample> depth_samples(const BoardObservations& observations,
                                       const std::vector<bool>& used,
                                       const RgbdParameters& parameters, double extent);

/// Intersects the ray of a depth pixel with the flat board. Returns x, y in the board frame and
/// the depth in the depth camera's frame [m].
Eigen::Vector3d intersect_board(const Eigen::Vector2d& pixel, std::size_t view,
                                const RgbdParameters& parameters);

/// Estimates the noise from the residuals, removes samples beyond 4 sigma, and sets sigma_m of all
/// others. `poses_settled`: the poses were fitted to depth; until then, an error that a whole view
/// has in common is attributed to its pose, not to correlated noise.
DepthNoise reweight_samples(std::vector<DepthSample>& samples, const RgbdParameters& parameters,
                            bool poses_settled);

}  // namespace touchtrace
