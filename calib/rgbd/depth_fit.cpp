#include "calib/rgbd/depth_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "calib/rgbd/board_motion.h"
#include "calib/rgbd/design_effect.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr double samples_per_view = 120.0;
constexpr int max_block_px = 16;
constexpr double plane_gate = 0.15;  ///< maximum distance from the plane, fraction of the depth
constexpr double outlier_sigmas = 4.0;

/// Flat board and depth camera of one view.
struct BoardPlane {
  Eigen::Isometry3d board_from_depth;
  std::array<double, 4> camera;

  /// As intersect_board().
  Eigen::Vector3d hit(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray((pixel.x() - camera[2]) / camera[0],
                              (pixel.y() - camera[3]) / camera[1], 1.0);
    const Eigen::Vector3d origin = board_from_depth.translation();
    const Eigen::Vector3d direction = board_from_depth.linear() * ray;
    const double depth = -origin.z() / direction.z();
    return {origin.x() + depth * direction.x(), origin.y() + depth * direction.y(), depth};
  }
};

BoardPlane board_plane(std::size_t view, const RgbdParameters& p) {
  const Eigen::Isometry3d depth_from_board =
      pose_of(p.depth_from_color) * pose_of(p.camera_from_board[view]);
  return {depth_from_board.inverse(), p.depth};
}

bool is_on_board(const CalibrationTarget& board, const Eigen::Vector3d& hit, double extent) {
  const double width = board.size_m().x(), height = board.size_m().y();
  return hit.z() > 0.0 && std::abs(hit.x() - 0.5 * width) <= 0.5 * extent * width &&
         std::abs(hit.y() - 0.5 * height) <= 0.5 * extent * height;
}

/// Area [px] of the inner corners' rectangle seen frontally at the depth of its centre.
double board_area_px(const CalibrationTarget& board, const BoardPlane& plane) {
  const Eigen::Vector3d centre = 0.5 * board.corner_m(board.num_corners() - 1);
  const double depth = (plane.board_from_depth.inverse() * centre).z();
  return 4.0 * centre.x() * centre.y() * plane.camera[0] * plane.camera[1] / (depth * depth);
}

/// Mean over the valid pixels of a block; not used if a pixel is off the board. Averages inverse
/// depth, which is linear over the image of a plane.
struct BlockMean {
  Eigen::Vector2d pixel_sum = Eigen::Vector2d::Zero(), board_sum_m = Eigen::Vector2d::Zero();
  double inverse_sum = 0.0;
  int count = 0;
  bool is_on_board = true;

  void add(const Eigen::Vector2d& pixel, double measured_m, bool inside,
           const Eigen::Vector3d& hit) {
    is_on_board = is_on_board && inside;
    if (!inside || !(measured_m > 0.0) || std::abs(measured_m - hit.z()) > plane_gate * hit.z())
      return;
    pixel_sum += pixel, board_sum_m += hit.head<2>(), inverse_sum += 1.0 / measured_m, ++count;
  }
};

BlockMean block_mean(const BoardObservations& o, std::size_t view, const BoardPlane& plane,
                     double extent, int x0, int y0, int size) {
  BlockMean mean;
  for (int y = y0; y < y0 + size && mean.is_on_board; ++y)
    for (int x = x0; x < x0 + size && mean.is_on_board; ++x) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector3d hit = plane.hit(pixel);
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(o.width) +
                         static_cast<std::size_t>(x);
      mean.add(pixel, o.views[view].depth_m[index], is_on_board(o.board, hit, extent), hit);
    }
  return mean;
}

/// Bounding box of the inner corners' rectangle in the depth image; empty if it is not visible.
Eigen::AlignedBox2i covered_pixels(const BoardObservations& o, const BoardPlane& plane) {
  const Eigen::Isometry3d depth_from_board = plane.board_from_depth.inverse();
  const int last = o.board.num_corners() - 1;
  Eigen::AlignedBox2d box;
  for (int corner : {0, o.board.columns - 1, last - o.board.columns + 1, last}) {
    const Eigen::Vector3d p = depth_from_board * o.board.corner_m(corner);
    if (!(p.z() > 0.0)) return {};
    box.extend(Eigen::Vector2d(plane.camera[0] * p.x() / p.z() + plane.camera[2],
                               plane.camera[1] * p.y() / p.z() + plane.camera[3]));
  }
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(),
                                  Eigen::Vector2d(o.width - 1, o.height - 1));
  const Eigen::AlignedBox2d visible = box.intersection(image);
  if (visible.isEmpty()) return {};
  return {visible.min().cast<int>(), visible.max().cast<int>()};
}

void add_samples(const BoardObservations& o, std::size_t view, const RgbdParameters& p,
                 const BoardMotion& motion, double extent, int size,
                 std::vector<DepthSample>& samples) {
  const BoardPlane plane = board_plane(view, p);
  const auto box = covered_pixels(o, plane);
  if (box.isEmpty()) return;
  for (int y = box.min().y(); y + size <= box.max().y() + 1; y += size)
    for (int x = box.min().x(); x + size <= box.max().x() + 1; x += size) {
      const BlockMean mean = block_mean(o, view, plane, extent, x, y, size);
      if (!mean.is_on_board || 2 * mean.count < size * size) continue;
      const double depth = mean.count / mean.inverse_sum;
      samples.push_back({view, mean.pixel_sum / mean.count, depth,
                         DepthNoise{}.effective_sigma_m(depth),
                         o.board.warp_basis(mean.board_sum_m / mean.count), motion});
    }
}

std::vector<double> depth_residuals(const std::vector<DepthSample>& samples,
                                    const RgbdParameters& p) {
  std::vector<double> residuals;
  for (const auto& sample : samples) residuals.push_back(depth_residual(sample, p));
  return residuals;
}

/// Maximum-likelihood noise, exponent included; `depths`: the model's depths [m].
DepthNoise estimate_noise(const std::vector<double>& residuals, const std::vector<double>& depths) {
  DepthNoise best;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto count = static_cast<double>(residuals.size());
  for (int exponent : {0, 1, 2}) {
    double squares = 0.0, logs = 0.0;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      squares += std::pow(residuals[i] / std::pow(depths[i], exponent), 2);
      logs += exponent * std::log(depths[i]);
    }
    const double sigma = std::max(std::sqrt(squares / count), 1e-9);
    const double cost = count * std::log(sigma) + logs;
    if (cost < best_cost) best_cost = cost, best = {sigma, exponent, 1.0};
  }
  return best;
}

}  // namespace

double DepthNoise::effective_sigma_m(double depth_m) const {
  return sigma_at_1m * std::pow(depth_m, exponent) * std::sqrt(inflation);
}

Eigen::Vector3d intersect_board(const Eigen::Vector2d& pixel, std::size_t view,
                                const RgbdParameters& parameters) {
  return board_plane(view, parameters).hit(pixel);
}

bool has_depth(const BoardObservations& observations) {
  return std::ranges::any_of(observations.views,
                             [](const BoardView& view) { return !view.depth_m.empty(); });
}

int depth_block_px(const BoardObservations& observations, const std::vector<bool>& used,
                   const RgbdParameters& parameters) {
  double area_px = 0.0, views = 0.0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view])
      area_px += board_area_px(observations.board, board_plane(view, parameters)), views += 1.0;
  const double size = std::sqrt(area_px / (views * samples_per_view));
  return static_cast<int>(std::clamp(size, 1.0, double(max_block_px)));
}

std::vector<DepthSample> depth_samples(const BoardObservations& observations,
                                       const std::vector<bool>& used,
                                       const RgbdParameters& parameters, double extent) {
  const int size = depth_block_px(observations, used, parameters);
  const auto motions = board_motions(observations, used, parameters);
  std::vector<DepthSample> samples;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view] && !observations.views[view].depth_m.empty())
      add_samples(observations, view, parameters, motions[view], extent, size, samples);
  return samples;
}

DepthNoise reweight_samples(std::vector<DepthSample>& samples, const RgbdParameters& parameters,
                            bool poses_settled) {
  std::vector<double> normalized;
  for (const auto& s : samples) normalized.push_back(depth_residual(s, parameters) / s.sigma_m);
  const double limit = outlier_sigmas * robust_sigma(normalized);
  std::erase_if(samples, [&](const DepthSample& s) {
    return !(std::abs(depth_residual(s, parameters) / s.sigma_m) <= limit);
  });
  const auto residuals = depth_residuals(samples, parameters);
  std::vector<double> depths;
  for (const auto& s : samples) depths.push_back(board_depth_m(s, parameters));
  DepthNoise noise = estimate_noise(residuals, depths);
  for (std::size_t i = 0; i < samples.size(); ++i)
    normalized[i] = residuals[i] / noise.effective_sigma_m(depths[i]);
  normalized.resize(samples.size());
  const DesignEffect effect = design_effect(samples, normalized);
  noise.inflation = poses_settled ? std::max(effect.planes, effect.tiles) : effect.tiles;
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].sigma_m = noise.effective_sigma_m(depths[i]);
  return noise;
}

}  // namespace touchtrace
