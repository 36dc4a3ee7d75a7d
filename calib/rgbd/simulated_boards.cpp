#include "calib/rgbd/simulated_boards.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/rgbd/depth_fit.h"
#include "calib/rgbd/prior.h"

namespace touchtrace {
namespace {

constexpr int width = 320, height = 240;
constexpr double border_px = 8.0;
constexpr double smallest_tilt_cosine = 0.6;

RgbdParameters true_cameras() {
  RgbdParameters truth;
  truth.color = {305.0, 304.0, 161.0, 118.5, -0.12, 0.05, 0.0015, -0.001, 0.0};
  truth.depth_from_color = {0.004, -0.012, 0.006, -0.025, 0.002, 0.001};
  truth.depth = {300.0, 300.0, 158.0, 121.0};
  truth.depth_correction = {1.012, -0.006};
  return truth;
}

/// A pose with the board's middle before the camera, turned in any direction and tilted up to 53
/// degrees.
std::array<double, 6> random_pose(const Chessboard& board, RandomStream& random) {
  const double z = random.uniform(0.35, 0.9);
  const Eigen::Vector3d middle(z * random.uniform(-0.35, 0.35), z * random.uniform(-0.25, 0.25), z);
  const Eigen::Vector3d turn(random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9),
                             random.uniform(-1.6, 1.6));
  std::array<double, 6> pose{turn.x(), turn.y(), turn.z()};
  const Eigen::Vector3d centre = 0.5 * board.corner_m(board.corners() - 1);
  const Eigen::Vector3d translation = middle - pose_of(pose).linear() * centre;
  std::copy_n(translation.data(), 3, pose.begin() + 3);
  return pose;
}

std::vector<Eigen::Vector2d> projected(const Chessboard& board, const std::array<double, 9>& color,
                                       const std::array<double, 6>& pose) {
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < board.corners(); ++i)
    corners.push_back(
        project_point(color.data(), Eigen::Vector3d(pose_of(pose) * board.corner_m(i))));
  return corners;
}

bool in_image(const std::vector<Eigen::Vector2d>& corners) {
  return std::ranges::all_of(corners, [](const Eigen::Vector2d& c) {
    return c.x() > border_px && c.y() > border_px && c.x() < width - border_px &&
           c.y() < height - border_px;
  });
}

bool usable(const std::array<double, 6>& pose, const std::vector<Eigen::Vector2d>& corners) {
  return in_image(corners) && pose_of(pose).linear()(2, 2) > smallest_tilt_cosine;
}

/// What a depth camera without noise measures of the whole plane of the board.
std::vector<float> clean_depth(const RgbdParameters& truth, std::size_t view) {
  std::vector<float> depth;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double plane = plane_depth_m(Eigen::Vector2d(x, y), view, truth);
      const double measured = (plane - truth.depth_correction[1]) / truth.depth_correction[0];
      depth.push_back(static_cast<float>(measured > 0.1 && measured < 5.0 ? measured : 0.0));
    }
  return depth;
}

Eigen::Vector3d rotation_error(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth) {
  const Eigen::AngleAxisd difference(estimate * truth.transpose());
  return difference.angle() * difference.axis();
}

}  // namespace

SimulatedBoards simulated_boards(int views, bool with_depth) {
  SimulatedBoards boards;
  boards.truth = true_cameras();
  boards.clean.width = width, boards.clean.height = height;
  RandomStream random(1, "simulated boards");
  while (static_cast<int>(boards.clean.views.size()) < views) {
    const auto pose = random_pose(boards.clean.board, random);
    auto corners = projected(boards.clean.board, boards.truth.color, pose);
    if (!usable(pose, corners)) continue;
    const std::size_t view = boards.clean.views.size();
    boards.truth.camera_from_board.push_back(pose);
    boards.clean.views.push_back({"view " + std::to_string(view), std::move(corners), {}});
    if (with_depth) boards.clean.views.back().depth_m = clean_depth(boards.truth, view);
  }
  boards.clean.depth_intrinsics = boards.truth.depth;
  return boards;
}

SimulatedBoards with_distortion(SimulatedBoards boards, const std::array<double, 5>& distortion) {
  std::ranges::copy(distortion, boards.truth.color.begin() + 4);
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view)
    boards.clean.views[view].corners_px =
        projected(boards.clean.board, boards.truth.color, boards.truth.camera_from_board[view]);
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
  cx += factory_relative_sigma * width * random.normal();
  cy += factory_relative_sigma * width * random.normal();
  return observed;
}

Eigen::VectorXd errors(const RgbdCalibration& c, const RgbdParameters& truth) {
  const auto color = static_cast<Eigen::Index>(c.parameters.size()) - (c.depth ? 12 : 0);
  Eigen::VectorXd error(static_cast<Eigen::Index>(c.parameters.size()));
  const auto estimated = c.color.parameters();
  for (Eigen::Index i = 0; i < color; ++i)
    error[i] = estimated[static_cast<std::size_t>(i)] - truth.color[static_cast<std::size_t>(i)];
  if (!c.depth) return error;
  const Eigen::Isometry3d pose = pose_of(truth.depth_from_color);
  const Eigen::Map<const Eigen::Vector4d> depth(truth.depth.data());
  error.segment<3>(color) = rotation_error(c.depth_from_color.linear(), pose.linear());
  error.segment<3>(color + 3) = c.depth_from_color.translation() - pose.translation();
  error.segment<4>(color + 6) =
      Eigen::Vector4d(c.depth->fx, c.depth->fy, c.depth->cx, c.depth->cy) - depth;
  error[color + 10] = c.depth_scale - truth.depth_correction[0];
  error[color + 11] = c.depth_offset_m - truth.depth_correction[1];
  return error;
}

Eigen::MatrixXd cramer_rao_bound(const SimulatedBoards& boards) {
  const auto& o = boards.clean;
  BoardProblem problem{o, std::vector<bool>(o.views.size(), true), {}, color_prior(o)};
  add_depth_prior(o, boards.truth, problem.prior);
  problem.free_color = {0, 1, 2, 3, 4, 5, 6, 7};
  problem.corner_sigma_px = boards.corner_sigma_px;
  problem.samples = depth_samples(o, problem.used, boards.truth, 1.0);
  const int block = depth_block_px(o, problem.used, boards.truth);
  for (auto& sample : problem.samples)
    sample.sigma_m = boards.depth_sigma_at_1m * sample.measured_m * sample.measured_m / block;
  return covariance(problem, boards.truth);
}

}  // namespace touchtrace
