#include "calib/rig/rig_start.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "calib/board/view_order.h"
#include "calib/rgbd/calibrate.h"
#include "calib/rgbd/corner_error.h"
#include "calib/rgbd/initial_guess.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/target_deformation.h"
#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

using Eigen::Isometry3d;

/// Two cameras and the frames that both see.
struct Link {
  std::size_t first = 0, second = 0;  ///< first: nearer to the rig's first camera
  std::vector<std::size_t> frames = {};
};

Link link_between(std::size_t first, std::size_t second, const std::vector<RigFrame>& frames,
                  const std::vector<bool>& used) {
  Link link{first, second};
  for (std::size_t frame = 0; frame < frames.size(); ++frame)
    if (used[frame] && frames[frame].views[first] && frames[frame].views[second])
      link.frames.push_back(frame);
  return link;
}

/// Links that connect all cameras to the first one, each time by the most frames.
std::vector<Link> spanning_tree(const std::vector<RigFrame>& frames, const std::vector<bool>& used,
                                const std::vector<std::string>& names) {
  std::vector<bool> is_linked(names.size(), false);
  is_linked[0] = true;
  std::vector<Link> tree;
  while (tree.size() + 1 < names.size()) {
    Link best;
    for (std::size_t a = 0; a < names.size(); ++a)
      for (std::size_t b = 0; b < names.size(); ++b) {
        if (!is_linked[a] || is_linked[b]) continue;
        Link link = link_between(a, b, frames, used);
        if (best.second == 0 || link.frames.size() > best.frames.size()) best = std::move(link);
      }
    if (best.frames.size() < std::size_t(min_views))
      throw data_error(
          fmt::format("only {} usable frames show the board to camera {} and camera {} at once; {} "
                      "are needed",
                      best.frames.size(), names[best.first], names[best.second], min_views),
          "give simultaneous images the same number (left01.jpg, right01.jpg), and show the whole "
          "board to both cameras");
    is_linked[best.second] = true;
    tree.push_back(std::move(best));
  }
  return tree;
}

/// A calibrated camera with the pose of the board in each view.
struct PosedCamera {
  const BoardObservations* observations;
  RgbdParameters parameters;

  Isometry3d pose(std::size_t view) const { return pose_of(parameters.camera_from_board[view]); }
};

PosedCamera pose_views(const RgbdCalibration& calibration, const BoardObservations& o) {
  PosedCamera posed{&o, board_parameters(calibration)};
  posed.parameters.lens = calibration.color.lens;
  posed.parameters.color = calibration.color.parameters();
  for (const auto& view : o.views)
    posed.parameters.camera_from_board.push_back(initial_pose(view, o.board, calibration.color));
  BoardProblem problem{
      o, std::vector<bool>(o.views.size(), true), {}, color_prior(o, calibration.color.lens)};
  problem.prior.deformation_sigma_m =
      calibration.details["target_deformation"]["sigma_m"].get<double>();
  problem.estimated = Estimated::board_poses;
  solve(problem, posed.parameters);  // else the initial poses
  return posed;
}

/// Turns the board by 180 degrees about its centre: corner i becomes corner n - 1 - i.
Isometry3d half_turn(const CalibrationTarget& board) {
  Isometry3d turn = Isometry3d::Identity();
  turn.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  turn.translation() = board.corner_m(board.num_corners() - 1);
  return turn;
}

/// RMS [px] of the corners of a view, if the board is at `camera_from_board`.
double rms_at(const PosedCamera& camera, std::size_t view, const Isometry3d& camera_from_board) {
  RgbdParameters moved = camera.parameters;
  moved.camera_from_board[view] = angle_axis_pose(camera_from_board);
  return rms(corner_residuals(*camera.observations, view, moved));
}

/// Error [px] of the second view, if its board is where the first view and `second_from_first` say.
struct Transfer {
  double rms_px;
  bool is_half_turn;
};

Transfer transfer(const PosedCamera& first, std::size_t first_view, const PosedCamera& second,
                  std::size_t second_view, const Isometry3d& second_from_first) {
  const CalibrationTarget& board = first.observations->board;
  const Isometry3d pose = second_from_first * first.pose(first_view);
  const double same_px = rms_at(second, second_view, pose);
  if (!board.is_symmetric()) return {same_px, false};
  const double turned_px = rms_at(second, second_view, pose * half_turn(board));
  return {std::min(same_px, turned_px), turned_px < same_px};
}

Isometry3d relative_pose(const PosedCamera& first, const PosedCamera& second, const Link& link,
                         const std::vector<RigFrame>& frames) {
  const auto views = [&](std::size_t frame) {
    return std::pair(*frames[frame].views[link.first], *frames[frame].views[link.second]);
  };
  std::vector<Isometry3d> board_turns{Isometry3d::Identity()};
  if (first.observations->board.is_symmetric())
    board_turns.push_back(half_turn(first.observations->board));
  Isometry3d best = Isometry3d::Identity();
  double min_px = std::numeric_limits<double>::infinity();
  for (std::size_t frame : link.frames)
    for (const Isometry3d& turn : board_turns) {
      const auto [a, b] = views(frame);
      const Isometry3d candidate = second.pose(b) * turn * first.pose(a).inverse();
      std::vector<double> errors_px;
      for (std::size_t other : link.frames) {
        const auto [c, d] = views(other);
        errors_px.push_back(transfer(first, c, second, d, candidate).rms_px);
      }
      const double typical_px = median(std::move(errors_px));
      if (typical_px < min_px) best = candidate, min_px = typical_px;
    }
  return best;
}

/// Poses of the board from the first view of each frame; turns the board by half in the other views
/// where that fits better.
void place_boards(const std::vector<PosedCamera>& cameras, const std::vector<RigFrame>& frames,
                  RigParameters& p, std::vector<BoardObservations>& observations) {
  for (const RigFrame& frame : frames) {
    std::optional<std::size_t> first;
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
      if (!frame.views[camera]) continue;
      const std::size_t view = *frame.views[camera];
      if (!first) {
        first = camera;
        p.rig_from_board.push_back(angle_axis_pose(
            pose_of(p.cameras[camera].camera_from_rig).inverse() * cameras[camera].pose(view)));
        continue;
      }
      const Isometry3d camera_from_first = pose_of(p.cameras[camera].camera_from_rig) *
                                           pose_of(p.cameras[*first].camera_from_rig).inverse();
      if (transfer(cameras[*first], *frame.views[*first], cameras[camera], view, camera_from_first)
              .is_half_turn)
        turn_by_half(observations[camera].views[view], observations[camera].board);
    }
  }
}

}  // namespace

void require_connected(const std::vector<RigFrame>& frames, const std::vector<bool>& used,
                       const std::vector<std::string>& names) {
  spanning_tree(frames, used, names);
}

RigParameters rig_start(const std::vector<RgbdCalibration>& calibrations,
                        const std::vector<std::string>& names, const std::vector<RigFrame>& frames,
                        std::vector<BoardObservations>& observations) {
  RigParameters p;
  std::vector<PosedCamera> cameras;
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    cameras.push_back(pose_views(calibrations[i], observations[i]));
    p.cameras.push_back({cameras[i].parameters.lens, cameras[i].parameters.color});
  }
  for (const Link& link : spanning_tree(frames, std::vector<bool>(frames.size(), true), names))
    p.cameras[link.second].camera_from_rig =
        angle_axis_pose(relative_pose(cameras[link.first], cameras[link.second], link, frames) *
                        pose_of(p.cameras[link.first].camera_from_rig));
  p.board_warp_m = calibrations.front().board_warp_m;
  p.corner_offsets_m.resize(std::size_t(observations.front().board.num_corners()),
                            Eigen::Vector3d::Zero());
  place_boards(cameras, frames, p, observations);
  return p;
}

}  // namespace touchtrace
