#include "calib/rgbd/prior.h"

#include <algorithm>
#include <limits>

namespace touchtrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double centre_sigma = 0.1;            ///< fraction of the width
constexpr double guessed_relative_sigma = 0.1;  ///< colour intrinsics used for the depth camera
constexpr double relative_warp_sigma = 0.005;   ///< fraction of the board's diagonal
constexpr double flat_warp_sigma_m = 1e-7;
constexpr double pose_sigma_rad = 0.1, pose_sigma_m = 0.1;
constexpr double scale_sigma = 0.05, offset_sigma_m = 0.05;
constexpr double delay_sigma_s = 0.1;

}  // namespace

double warp_sigma_m(const CalibrationTarget& board) {
  if (board.is_flat) return flat_warp_sigma_m;
  return relative_warp_sigma * (board.corner_m(board.num_corners() - 1) - board.corner_m(0)).norm();
}

Prior color_prior(const BoardObservations& o, const Lens& lens) {
  Prior prior;
  prior.color_sigma.fill(infinity);
  prior.color_mean[2] = 0.5 * (o.width - 1), prior.color_mean[3] = 0.5 * (o.height - 1);
  prior.color_sigma[2] = prior.color_sigma[3] = centre_sigma * o.width;
  const auto names = coefficient_names(lens);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == "p1" || names[i] == "p2") prior.color_sigma[4 + i] = tangential_sigma;
  prior.warp_sigma_m = warp_sigma_m(o.board);
  return prior;
}

void add_depth_prior(const BoardObservations& o, const RgbdParameters& p, Prior& prior) {
  const bool known = o.depth_intrinsics[0] > 0.0;
  const double relative = known ? factory_relative_sigma : guessed_relative_sigma;
  if (known) prior.depth_mean = o.depth_intrinsics;
  if (!known) std::copy_n(p.color.begin(), 4, prior.depth_mean.begin());
  prior.depth_sigma = {relative * prior.depth_mean[0], relative * prior.depth_mean[1],
                       relative * o.width, relative * o.width};
  prior.pose_sigma = {pose_sigma_rad, pose_sigma_rad, pose_sigma_rad,
                      pose_sigma_m,   pose_sigma_m,   pose_sigma_m};
  prior.correction_sigma = {scale_sigma, offset_sigma_m};
  prior.delay_sigma_s = delay_sigma_s;
}

}  // namespace touchtrace
