#include "tests/verify/calib/simulated_boards.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/lens_choice.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {
namespace {

constexpr int reference_width = 320;
constexpr double border = 0.025;  ///< of the width
constexpr double smallest_tilt_cosine = 0.6;
constexpr double least_axis_cosine = 0.25;  ///< of a corner: 75 degrees to the side
constexpr double frame_s = 1.0 / 30.0;
constexpr double nearest_m = 0.35, farthest_m = 0.9;

RgbdParameters true_cameras(double size) {
  RgbdParameters truth;
  truth.lens = Radtan4{};
  truth.color = {305.0 * size, 304.0 * size, 161.0 * size, 118.5 * size,
                 -0.12,        0.05,         0.0015,       -0.001};
  truth.depth_from_color = {0.004, -0.012, 0.006, -0.025, 0.002, 0.001};
  truth.depth = {300.0 * size, 300.0 * size, 158.0 * size, 121.0 * size};
  truth.depth_correction = {1.012, -0.006};
  return truth;
}

RgbdParameters true_fisheye() {
  RgbdParameters truth;
  truth.lens = Fisheye4{};
  truth.color = {245.0, 244.0, 321.0, 238.0, 0.02, -0.015, 0.006, -0.001};
  return truth;
}

std::array<double, 6> facing(const Chessboard& board, const Eigen::Matrix3d& rotation,
                             const Eigen::Vector3d& middle_m) {
  const Eigen::AngleAxisd turn(rotation);
  const Eigen::Vector3d r = turn.angle() * turn.axis();
  const Eigen::Vector3d t = middle_m - rotation * (0.5 * board.corner_m(board.corners() - 1));
  return {r.x(), r.y(), r.z(), t.x(), t.y(), t.z()};
}

/// Turned in any direction and tilted up to 53 degrees.
Eigen::Matrix3d random_turn(RandomStream& random) {
  const double x = random.uniform(-0.9, 0.9), y = random.uniform(-0.9, 0.9);
  const Eigen::Vector3d turn(x, y, random.uniform(-1.6, 1.6));
  return rotation_matrix(turn);
}

/// The board's middle in the direction of `x`, `y`.
std::array<double, 6> pose_before(const Chessboard& board, RandomStream& random) {
  const double z = random.uniform(nearest_m, farthest_m), x = random.uniform(-0.35, 0.35);
  const Eigen::Vector3d middle(z * x, z * random.uniform(-0.25, 0.25), z);
  return facing(board, random_turn(random), middle);
}

/// Up to 60 degrees to the side, looking at the camera before it is tilted.
std::array<double, 6> pose_around(const Chessboard& board, RandomStream& random) {
  const double across = random.uniform(-1.0, 1.0), down = random.uniform(-0.7, 0.7);
  const Eigen::Matrix3d aim = rotation_matrix({-down, across, 0.0});
  const Eigen::Vector3d middle = aim.col(2) * random.uniform(0.2, 0.5);
  return facing(board, aim * random_turn(random), middle);
}

std::vector<Eigen::Vector2d> projected(const SimulatedBoards& boards,
                                       const std::array<double, 6>& pose) {
  const RgbdParameters& truth = boards.truth;
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < boards.clean.board.corners(); ++i) {
    const Eigen::Vector3d point = pose_of(pose) * corner_on_board(boards.clean.board, i, truth);
    corners.push_back(with_lens(truth.lens, [&](auto l) -> Eigen::Vector2d {
      return project_point<decltype(l)>(truth.color.data(), point);
    }));
  }
  return corners;
}

bool in_image(const BoardObservations& o, const std::vector<Eigen::Vector2d>& corners) {
  const double margin = border * o.width;
  return std::ranges::all_of(corners, [&](const Eigen::Vector2d& c) {
    return c.x() > margin && c.y() > margin && c.x() < o.width - margin &&
           c.y() < o.height - margin;
  });
}

/// So that a perspective lens sees it, too.
bool before_camera(const Chessboard& board, const Eigen::Isometry3d& camera_from_board) {
  for (int i = 0; i < board.corners(); ++i) {
    const Eigen::Vector3d corner = camera_from_board * board.corner_m(i);
    if (!(corner.z() > least_axis_cosine * corner.norm())) return false;
  }
  return true;
}

/// Seen whole and not too much from the side.
bool usable(const BoardObservations& o, const std::array<double, 6>& pose,
            const std::vector<Eigen::Vector2d>& corners) {
  const Eigen::Isometry3d camera_from_board = pose_of(pose);
  const Eigen::Vector3d middle =
      camera_from_board * (0.5 * o.board.corner_m(o.board.corners() - 1)).eval();
  return in_image(o, corners) && before_camera(o.board, camera_from_board) &&
         camera_from_board.linear().col(2).dot(middle.normalized()) > smallest_tilt_cosine;
}

template <class Pose>
void add_views(SimulatedBoards& boards, int views, const char* stream, Pose&& draw) {
  RandomStream random(1, stream);
  while (static_cast<int>(boards.clean.views.size()) < views) {
    const std::array<double, 6> pose = draw(boards.clean.board, random);
    auto corners = projected(boards, pose);
    if (!usable(boards.clean, pose, corners)) continue;
    boards.truth.camera_from_board.push_back(pose);
    boards.clean.views.push_back(
        {"view " + std::to_string(boards.clean.views.size()), std::move(corners), {}});
  }
}

void project_again(SimulatedBoards& boards) {
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view)
    boards.clean.views[view].corners_px = projected(boards, boards.truth.camera_from_board[view]);
}

/// What a depth camera without noise measures of the whole plane of the board.
std::vector<float> clean_depth(const BoardObservations& o, const RgbdParameters& truth,
                               std::size_t view, const BoardMotion& motion = {}) {
  std::vector<float> depth;
  for (int y = 0; y < o.height; ++y)
    for (int x = 0; x < o.width; ++x) {
      const double plane_m = board_depth_m(
          {view, Eigen::Vector2d(x, y), 0.0, 1.0, Eigen::Vector2d::Zero(), motion}, truth);
      const double measured = (plane_m - truth.depth_correction[1]) / truth.depth_correction[0];
      depth.push_back(static_cast<float>(measured > 0.1 && measured < 5.0 ? measured : 0.0));
    }
  return depth;
}

Eigen::Vector3d rotation_error(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth) {
  const Eigen::AngleAxisd difference(estimate * truth.transpose());
  return difference.angle() * difference.axis();
}

}  // namespace

SimulatedBoards simulated_boards(int views, bool with_depth, int width) {
  SimulatedBoards boards;
  boards.truth = true_cameras(double(width) / reference_width);
  boards.clean.width = width, boards.clean.height = width * 3 / 4;
  add_views(boards, views, "simulated boards", pose_before);
  if (!with_depth) return boards;
  boards.clean.depth_intrinsics = boards.truth.depth;
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view)
    boards.clean.views[view].depth_m = clean_depth(boards.clean, boards.truth, view);
  return boards;
}

SimulatedBoards simulated_moving_boards(int views, double delay_s) {
  SimulatedBoards boards = simulated_boards(views, false);
  auto& seen = boards.clean.views;
  auto& poses = boards.truth.camera_from_board;
  boards.truth.depth_delay_s = delay_s;
  boards.clean.depth_intrinsics = boards.truth.depth;
  RandomStream random(1, "simulated motion");
  std::vector<BoardMotion> motions;
  for (std::size_t view = 0; view < static_cast<std::size_t>(views); ++view) {
    BoardMotion motion;
    for (double& speed : motion.linear_m_s) speed = random.normal(0.0, 0.2);
    for (double& rate : motion.angular_rad_s) rate = random.normal(0.0, 0.4);
    motion.depth_after_color_s = random.uniform(-0.01, 0.01);
    auto later = pose_of(poses[view]);
    later.translation() += frame_s * motion.linear_m_s;
    later.linear() = rotation_matrix(frame_s * motion.angular_rad_s) * later.linear();
    poses.push_back(facing(
        boards.clean.board, later.linear(),
        later * (0.5 * boards.clean.board.corner_m(boards.clean.board.corners() - 1)).eval()));
    seen.push_back({"view " + std::to_string(seen.size()), projected(boards, poses.back()), {}});
    for (const std::size_t at : {view, seen.size() - 1}) {
      seen[at].color_time_s = double(view) + (at == view ? 0.0 : frame_s);
      seen[at].depth_time_s = seen[at].color_time_s + motion.depth_after_color_s;
    }
    motions.push_back(motion);
  }
  for (std::size_t view = 0; view < seen.size(); ++view)
    seen[view].depth_m = clean_depth(boards.clean, boards.truth, view,
                                     motions[view % static_cast<std::size_t>(views)]);
  return boards;
}

SimulatedBoards simulated_fisheye_boards(int views) {
  SimulatedBoards boards;
  boards.truth = true_fisheye();
  boards.clean.width = 640, boards.clean.height = 480;
  add_views(boards, views, "simulated fisheye boards", pose_around);
  return boards;
}

SimulatedBoards seen_through(SimulatedBoards boards, const Lens& lens,
                             const std::array<double, max_coefficients>& coefficients) {
  boards.truth.lens = lens;
  std::ranges::copy(coefficients, boards.truth.color.begin() + 4);
  project_again(boards);
  return boards;
}

SimulatedBoards warped(SimulatedBoards boards, const std::array<double, 2>& warp_m) {
  boards.truth.board_warp_m = warp_m;
  project_again(boards);
  return boards;
}

SimulatedBoards misprinted(SimulatedBoards boards, double sigma_m, RandomStream& random) {
  boards.print_sigma_m = sigma_m;
  boards.truth.board_offsets_m.resize(std::size_t(boards.clean.board.corners()));
  for (auto& offset_m : boards.truth.board_offsets_m)
    for (double& coordinate_m : offset_m) coordinate_m = random.normal(0.0, sigma_m);
  project_again(boards);
  return boards;
}

BoardObservations observe(const SimulatedBoards& boards, RandomStream& random) {
  BoardObservations observed = boards.clean;
  for (auto& view : observed.views) {
    for (auto& corner : view.corners_px)
      corner += boards.corner_sigma_px * Eigen::Vector2d(random.normal(), random.normal());
    for (float& depth : view.depth_m)
      depth += static_cast<float>(boards.depth_sigma_at_1m * depth * depth * random.normal());
  }
  auto& [fx, fy, cx, cy] = observed.depth_intrinsics;
  fx *= 1.0 + factory_relative_sigma * random.normal();
  fy *= 1.0 + factory_relative_sigma * random.normal();
  cx += factory_relative_sigma * observed.width * random.normal();
  cy += factory_relative_sigma * observed.width * random.normal();
  return observed;
}

Eigen::VectorXd errors(const RgbdCalibration& c, const RgbdParameters& truth) {
  const auto estimated = c.color.parameters();
  const auto names = intrinsic_names(c.color.lens);
  Eigen::VectorXd error(static_cast<Eigen::Index>(c.parameters.size()));
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (at < error.size() && c.parameters[static_cast<std::size_t>(at)] == "color." + names[i])
      error[at++] = estimated[i] - truth.color[i];
  error[at++] = c.board_warp_m[0] - truth.board_warp_m[0];
  error[at++] = c.board_warp_m[1] - truth.board_warp_m[1];
  if (!c.depth) return error;
  const Eigen::Isometry3d pose = pose_of(truth.depth_from_color);
  const Eigen::Map<const Eigen::Vector4d> depth(truth.depth.data());
  error.segment<3>(at) = rotation_error(c.depth_from_color.linear(), pose.linear());
  error.segment<3>(at + 3) = c.depth_from_color.translation() - pose.translation();
  error.segment<4>(at + 6) =
      Eigen::Vector4d(c.depth->fx, c.depth->fy, c.depth->cx, c.depth->cy) - depth;
  error[at + 10] = c.depth_scale - truth.depth_correction[0];
  error[at + 11] = c.depth_offset_m - truth.depth_correction[1];
  if (at + 12 < error.size()) error[at + 12] = c.depth_delay_s - truth.depth_delay_s;
  return error;
}

Eigen::MatrixXd cramer_rao_bound(const SimulatedBoards& boards) {
  const auto& o = boards.clean;
  BoardProblem problem{
      o, std::vector<bool>(o.views.size(), true), {}, color_prior(o, boards.truth.lens)};
  add_depth_prior(o, boards.truth, problem.prior);
  problem.prior.print_sigma_m = boards.print_sigma_m;
  problem.free_color = lens_choice(lens_name(boards.truth.lens)).free_color;
  problem.corner_sigma_px = boards.corner_sigma_px;
  problem.samples = depth_samples(o, problem.used, boards.truth, 1.0);
  const int block = depth_block_px(o, problem.used, boards.truth);
  for (auto& sample : problem.samples)
    sample.sigma_m = boards.depth_sigma_at_1m * sample.measured_m * sample.measured_m / block;
  return covariance(problem, boards.truth);
}

}  // namespace touchtrace
