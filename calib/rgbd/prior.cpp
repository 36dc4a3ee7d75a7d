#include "calib/rgbd/prior.h"

#include <algorithm>
#include <limits>

namespace touchtrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double centre_sigma = 0.1;  // of the width
constexpr double guessed_sigma =
    0.1;  // relative, of the colour camera's intrinsics for the depth camera
constexpr double pose_sigma_rad = 0.1, pose_sigma_m = 0.1;
constexpr double scale_sigma = 0.05, offset_sigma_m = 0.05;

}  // namespace

Prior color_prior(const BoardObservations& o) {
  Prior prior;
  prior.color_sigma.fill(infinity);
  prior.color_mean[2] = 0.5 * (o.width - 1), prior.color_mean[3] = 0.5 * (o.height - 1);
  prior.color_sigma[2] = prior.color_sigma[3] = centre_sigma * o.width;
  prior.color_sigma[6] = prior.color_sigma[7] = tangential_sigma;
  return prior;
}

void add_depth_prior(const BoardObservations& o, const RgbdParameters& p, Prior& prior) {
  const bool known = o.depth_intrinsics[0] > 0.0;
  const double relative = known ? factory_relative_sigma : guessed_sigma;
  if (known) prior.depth_mean = o.depth_intrinsics;
  if (!known) std::copy_n(p.color.begin(), 4, prior.depth_mean.begin());
  prior.depth_sigma = {relative * prior.depth_mean[0], relative * prior.depth_mean[1],
                       relative * o.width, relative * o.width};
  prior.pose_sigma = {pose_sigma_rad, pose_sigma_rad, pose_sigma_rad,
                      pose_sigma_m,   pose_sigma_m,   pose_sigma_m};
  prior.correction_sigma = {scale_sigma, offset_sigma_m};
}

}  // namespace touchtrace
