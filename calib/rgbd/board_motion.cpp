#include "calib/rgbd/board_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

constexpr double min_speed_m_s = 0.02;
constexpr int min_moving_views = 3;

/// Index of the nearest used view before (side -1) or after (side 1) `view`; `view` if there is
/// none within max_gap_s.
std::size_t neighbour(const BoardObservations& o, const std::vector<bool>& used, std::size_t view,
                      double side) {
  std::size_t best = view;
  double nearest_s = max_gap_s;
  for (std::size_t other = 0; other < o.views.size(); ++other) {
    const double gap_s = side * (o.views[other].color_time_s - o.views[view].color_time_s);
    if (used[other] && gap_s > 0.0 && gap_s <= nearest_s) best = other, nearest_s = gap_s;
  }
  return best;
}

BoardMotion motion_between(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
                           double seconds) {
  const Eigen::AngleAxisd rotation(second.linear() * first.linear().transpose());
  return {(second.translation() - first.translation()) / seconds,
          rotation.angle() * rotation.axis() / seconds, 0.0};
}

}  // namespace

std::vector<BoardMotion> board_motions(const BoardObservations& o, const std::vector<bool>& used,
                                       const RgbdParameters& p) {
  std::vector<BoardMotion> motions(o.views.size());
  for (std::size_t view = 0; view < o.views.size(); ++view) {
    if (!used[view]) continue;
    const std::size_t before = neighbour(o, used, view, -1.0),
                      after = neighbour(o, used, view, 1.0);
    if (before == after) continue;
    const double seconds = o.views[after].color_time_s - o.views[before].color_time_s;
    motions[view] = motion_between(pose_of(p.camera_from_board[before]),
                                   pose_of(p.camera_from_board[after]), seconds);
    motions[view].depth_after_color_s = o.views[view].depth_time_s - o.views[view].color_time_s;
  }
  return motions;
}

bool is_delay_observable(const std::vector<BoardMotion>& motions) {
  return std::ranges::count_if(motions, [](const BoardMotion& motion) {
           return motion.linear_m_s.norm() > min_speed_m_s;
         }) >= min_moving_views;
}

}  // namespace touchtrace
