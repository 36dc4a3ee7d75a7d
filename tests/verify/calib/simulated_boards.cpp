#include "tests/verify/calib/simulated_boards.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/prior.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {
namespace {

constexpr int reference_width = 320;
constexpr double margin_fraction = 0.025;  ///< of the image width
constexpr double min_tilt_cosine = 0.6;
constexpr double min_axis_cosine = 0.25;  ///< corners are within 75 degrees of the optical axis
constexpr double frame_interval_s = 1.0 / 30.0;
constexpr double min_distance_m = 0.35, max_distance_m = 0.9;

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

std::array<double, 6> pose_with_centre(const CalibrationTarget& board,
                                       const Eigen::Matrix3d& rotation,
                                       const Eigen::Vector3d& centre_m) {
  const Eigen::AngleAxisd angle_axis(rotation);
  const Eigen::Vector3d r = angle_axis.angle() * angle_axis.axis();
  const Eigen::Vector3d t = centre_m - rotation * (0.5 * board.corner_m(board.num_corners() - 1));
  return {r.x(), r.y(), r.z(), t.x(), t.y(), t.z()};
}

/// Random rotation with a tilt of up to 53 degrees.
Eigen::Matrix3d random_rotation(RandomStream& random) {
  const double x = random.uniform(-0.9, 0.9), y = random.uniform(-0.9, 0.9);
  return rotation_matrix({x, y, random.uniform(-1.6, 1.6)});
}

/// Random pose in the field of view of a perspective camera.
std::array<double, 6> perspective_pose(const CalibrationTarget& board, RandomStream& random) {
  const double z = random.uniform(min_distance_m, max_distance_m), x = random.uniform(-0.35, 0.35);
  const Eigen::Vector3d centre(z * x, z * random.uniform(-0.25, 0.25), z);
  return pose_with_centre(board, random_rotation(random), centre);
}

/// Random pose up to 60 degrees off the optical axis; the board faces the camera, then is tilted.
std::array<double, 6> fisheye_pose(const CalibrationTarget& board, RandomStream& random) {
  const double across = random.uniform(-1.0, 1.0), down = random.uniform(-0.7, 0.7);
  const Eigen::Matrix3d aim = rotation_matrix({-down, across, 0.0});
  const Eigen::Vector3d centre = aim.col(2) * random.uniform(0.2, 0.5);
  return pose_with_centre(board, aim * random_rotation(random), centre);
}

std::vector<Eigen::Vector2d> project_corners(const SimulatedBoards& boards,
                                             const std::array<double, 6>& pose) {
  const RgbdParameters& truth = boards.truth;
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < boards.clean.board.num_corners(); ++i) {
    const Eigen::Vector3d point = pose_of(pose) * deformed_corner_m(boards.clean.board, i, truth);
    corners.push_back(with_lens(truth.lens, [&](auto l) -> Eigen::Vector2d {
      return project_point<decltype(l)>(truth.color.data(), point);
    }));
  }
  return corners;
}

bool is_in_image(const BoardObservations& o, const std::vector<Eigen::Vector2d>& corners) {
  const double margin = margin_fraction * o.width;
  return std::ranges::all_of(corners, [&](const Eigen::Vector2d& c) {
    return c.x() > margin && c.y() > margin && c.x() < o.width - margin &&
           c.y() < o.height - margin;
  });
}

/// True if a perspective lens can project the board, too.
bool is_before_camera(const CalibrationTarget& board, const Eigen::Isometry3d& camera_from_board) {
  for (int i = 0; i < board.num_corners(); ++i) {
    const Eigen::Vector3d corner = camera_from_board * board.corner_m(i);
    if (!(corner.z() > min_axis_cosine * corner.norm())) return false;
  }
  return true;
}

/// True if all corners are in the image and the board is not seen too obliquely.
bool is_usable(const BoardObservations& o, const std::array<double, 6>& pose,
               const std::vector<Eigen::Vector2d>& corners) {
  const Eigen::Isometry3d camera_from_board = pose_of(pose);
  const Eigen::Vector3d centre =
      camera_from_board * (0.5 * o.board.corner_m(o.board.num_corners() - 1)).eval();
  return is_in_image(o, corners) && is_before_camera(o.board, camera_from_board) &&
         camera_from_board.linear().col(2).dot(centre.normalized()) > min_tilt_cosine;
}

template <class Pose>
void add_views(SimulatedBoards& boards, int views, const char* stream, Pose&& draw) {
  RandomStream random(1, stream);
  while (static_cast<int>(boards.clean.views.size()) < views) {
    const std::array<double, 6> pose = draw(boards.clean.board, random);
    auto corners = project_corners(boards, pose);
    if (!is_usable(boards.clean, pose, corners)) continue;
    boards.truth.camera_from_board.push_back(pose);
    boards.clean.views.push_back(
        {"view " + std::to_string(boards.clean.views.size()), std::move(corners), {}});
  }
}

void update_corners(SimulatedBoards& boards) {
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view)
    boards.clean.views[view].corners_px =
        project_corners(boards, boards.truth.camera_from_board[view]);
}

/// Noise-free depth image of the board's unbounded plane.
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

LensChoice fitted_lens(const SimulatedBoards& boards) {
  return lens_choice(boards.fitted_lens.empty() ? lens_name(boards.truth.lens)
                                                : boards.fitted_lens);
}

SimulatedBoards simulated_boards(int views, bool with_depth, int width) {
  SimulatedBoards boards;
  boards.truth = true_cameras(double(width) / reference_width);
  boards.clean.width = width, boards.clean.height = width * 3 / 4;
  add_views(boards, views, "simulated boards", perspective_pose);
  if (!with_depth) return boards;
  boards.clean.depth_intrinsics = boards.truth.depth;
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view)
    boards.clean.views[view].depth_m = clean_depth(boards.clean, boards.truth, view);
  return boards;
}

SimulatedBoards simulated_moving_boards(int views, double delay_s) {
  SimulatedBoards boards = simulated_boards(views, false);
  auto& all_views = boards.clean.views;
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
    later.translation() += frame_interval_s * motion.linear_m_s;
    later.linear() = rotation_matrix(frame_interval_s * motion.angular_rad_s) * later.linear();
    poses.push_back(pose_with_centre(
        boards.clean.board, later.linear(),
        later * (0.5 * boards.clean.board.corner_m(boards.clean.board.num_corners() - 1)).eval()));
    all_views.push_back(
        {"view " + std::to_string(all_views.size()), project_corners(boards, poses.back()), {}});
    for (const std::size_t at : {view, all_views.size() - 1}) {
      all_views[at].color_time_s = double(view) + (at == view ? 0.0 : frame_interval_s);
      all_views[at].depth_time_s = all_views[at].color_time_s + motion.depth_after_color_s;
    }
    motions.push_back(motion);
  }
  for (std::size_t view = 0; view < all_views.size(); ++view)
    all_views[view].depth_m = clean_depth(boards.clean, boards.truth, view,
                                          motions[view % static_cast<std::size_t>(views)]);
  return boards;
}

SimulatedBoards simulated_fisheye_boards(int views) {
  SimulatedBoards boards;
  boards.truth = true_fisheye();
  boards.clean.width = 640, boards.clean.height = 480;
  add_views(boards, views, "simulated fisheye boards", fisheye_pose);
  return boards;
}

SimulatedBoards with_lens_coefficients(SimulatedBoards boards, const Lens& lens,
                                       const std::array<double, max_coefficients>& coefficients) {
  boards.truth.lens = lens;
  std::ranges::copy(coefficients, boards.truth.color.begin() + 4);
  update_corners(boards);
  return boards;
}

SimulatedBoards with_warp(SimulatedBoards boards, const std::array<double, 2>& warp_m) {
  boards.truth.board_warp_m = warp_m;
  update_corners(boards);
  return boards;
}

SimulatedBoards with_deformed_target(SimulatedBoards boards, double sigma_m, RandomStream& random) {
  boards.deformation_sigma_m = sigma_m;
  boards.truth.corner_offsets_m.resize(std::size_t(boards.clean.board.num_corners()));
  for (auto& offset_m : boards.truth.corner_offsets_m)
    for (double& coordinate_m : offset_m) coordinate_m = random.normal(0.0, sigma_m);
  update_corners(boards);
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

BoardObservations observe(const SimulatedBoards& boards, std::uint64_t seed) {
  RandomStream random(seed, "noise");
  return observe(boards, random);
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
  problem.prior.deformation_sigma_m = boards.deformation_sigma_m;
  problem.free_color = fitted_lens(boards).free_color;
  problem.corner_sigma_px = boards.corner_sigma_px;
  problem.samples = depth_samples(o, problem.used, boards.truth, 1.0);
  const int block = depth_block_px(o, problem.used, boards.truth);
  for (auto& sample : problem.samples)
    sample.sigma_m = boards.depth_sigma_at_1m * sample.measured_m * sample.measured_m / block;
  return covariance(problem, boards.truth);
}

}  // namespace touchtrace
