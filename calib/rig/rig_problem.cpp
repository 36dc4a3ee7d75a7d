#include "calib/rig/rig_problem.h"

#include <ceres/ceres.h>

#include <algorithm>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/cost_functions.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {
namespace {

using Eigen::Index;

/// Reprojection error of one corner. Parameter blocks: intrinsics, camera_from_rig, rig_from_board,
/// the board's warp, the corner's offset.
class RigCornerCost final : public ceres::CostFunction {
 public:
  explicit RigCornerCost(const CornerMeasurement& corner) : corner_(corner) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {num_intrinsics(corner.lens), 6, 6, 2, 3};
  }

  bool Evaluate(double const* const* parameters, double* residual,
                double** jacobians) const override {
    using Vector = Eigen::Map<const Eigen::Vector3d>;
    const Vector camera_rotation(parameters[1]), board_rotation(parameters[2]);
    const Eigen::Matrix3d camera_from_rig = rotation_matrix(camera_rotation),
                          rig_from_board = rotation_matrix(board_rotation);
    const Eigen::Vector3d rotated_board = rig_from_board *
                                          (corner_.warped_m(parameters[3]) + Vector(parameters[4])),
                          rotated_rig =
                              camera_from_rig * (rotated_board + Vector(parameters[2] + 3)),
                          p = rotated_rig + Vector(parameters[1] + 3);
    if (jacobians == nullptr) return corner_.set_error(parameters[0], p, residual);
    const ProjectionJacobian error = corner_.differentiate(parameters[0], p);
    Eigen::Map<Eigen::Vector2d>{residual} = error.pixel;
    const Eigen::Matrix<double, 2, 3> by_rig_point = error.by_point * camera_from_rig,
                                      by_board_point = by_rig_point * rig_from_board;
    set_jacobian(jacobians[0], error.by_intrinsics.leftCols(parameter_block_sizes()[0]));
    set_jacobian(jacobians[1],
                 derivative_by_pose(error.by_point, rotated_rig, left_jacobian(camera_rotation)));
    set_jacobian(jacobians[2],
                 derivative_by_pose(by_rig_point, rotated_board, left_jacobian(board_rotation)));
    set_jacobian(jacobians[3], by_board_point.col(2) * corner_.warp_basis.transpose());
    set_jacobian(jacobians[4], by_board_point);
    return error.pixel.allFinite();
  }

 private:
  CornerMeasurement corner_;
};

void add_view(const RigProblem& problem, std::size_t frame, std::size_t camera, RigParameters& p,
              ceres::LossFunction* loss, ceres::Problem& ceres_problem) {
  const BoardObservations& o = problem.observations[camera];
  const BoardView& view = o.views[*problem.frames[frame].views[camera]];
  RigCamera& c = p.cameras[camera];
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const int corner = view.corner_id(i);
    const Eigen::Vector3d flat_m = o.board.corner_m(corner);
    ceres_problem.AddResidualBlock(
        new RigCornerCost({c.lens, flat_m, o.board.warp_basis(flat_m.head<2>()), view.corners_px[i],
                           problem.corner_sigma_px[camera]}),
        loss, c.intrinsics.data(), c.camera_from_rig.data(), p.rig_from_board[frame].data(),
        p.board_warp_m.data(), p.corner_offsets_m[std::size_t(corner)].data());
  }
}

void add_camera(const RigProblem& problem, std::size_t camera, RigParameters& p,
                ceres::LossFunction* loss, ceres::Problem& ceres_problem) {
  RigCamera& c = p.cameras[camera];
  const int size = num_intrinsics(c.lens);
  const Prior& prior = problem.priors[camera];
  ceres_problem.AddResidualBlock(gaussian_prior(std::span(prior.color_mean).first(size),
                                                std::span(prior.color_sigma).first(size)),
                                 nullptr, c.intrinsics.data());
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (problem.used[frame] && problem.frames[frame].views[camera])
      add_view(problem, frame, camera, p, loss, ceres_problem);
  std::vector<int> fixed;
  for (int i = 0; i < size; ++i)
    if (std::ranges::find(problem.free[camera], i) == problem.free[camera].end())
      fixed.push_back(i);
  if (!fixed.empty())
    ceres_problem.SetManifold(c.intrinsics.data(), new ceres::SubsetManifold(size, fixed));
}

/// Blocks without residuals are not in the problem.
void fix(double* block, ceres::Problem& ceres_problem) {
  if (ceres_problem.HasParameterBlock(block)) ceres_problem.SetParameterBlockConstant(block);
}

void add_board(const RigProblem& problem, RigParameters& p, ceres::Problem& ceres_problem) {
  const double warp_m = problem.priors.front().warp_sigma_m, offset_m = problem.deformation_sigma_m;
  ceres_problem.AddResidualBlock(gaussian_prior({}, std::array{warp_m, warp_m}), nullptr,
                                 p.board_warp_m.data());
  for (auto& offset : p.corner_offsets_m) {
    if (offset_m > 0.0)
      ceres_problem.AddResidualBlock(gaussian_prior({}, std::array{offset_m, offset_m, offset_m}),
                                     nullptr, offset.data());
    else
      fix(offset.data(), ceres_problem);
  }
}

/// Estimates only the board's poses.
void fix_rig(RigParameters& p, ceres::Problem& ceres_problem) {
  fix(p.board_warp_m.data(), ceres_problem);
  for (auto& c : p.cameras)
    fix(c.intrinsics.data(), ceres_problem), fix(c.camera_from_rig.data(), ceres_problem);
  for (auto& offset : p.corner_offsets_m) fix(offset.data(), ceres_problem);
}

/// `ceres_problem` refers to the blocks of `p`.
void build(const RigProblem& problem, RigParameters& p, ceres::Problem& ceres_problem) {
  auto* loss = new ceres::HuberLoss(problem.loss_sigmas);
  for (std::size_t camera = 0; camera < p.cameras.size(); ++camera)
    add_camera(problem, camera, p, loss, ceres_problem);
  add_board(problem, p, ceres_problem);
  if (problem.fixed_rig) return fix_rig(p, ceres_problem);
  fix(p.cameras.front().camera_from_rig.data(), ceres_problem);
}

/// In the order of rig_parameter_names(), poses, offsets.
std::vector<double*> parameter_blocks(const RigProblem& problem, RigParameters& p) {
  std::vector<double*> blocks;
  for (auto& c : p.cameras) blocks.push_back(c.intrinsics.data());
  for (std::size_t i = 1; i < p.cameras.size(); ++i)
    blocks.push_back(p.cameras[i].camera_from_rig.data());
  blocks.push_back(p.board_warp_m.data());
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (problem.used[frame]) blocks.push_back(p.rig_from_board[frame].data());
  if (problem.deformation_sigma_m > 0.0)
    for (auto& offset : p.corner_offsets_m) blocks.push_back(offset.data());
  return blocks;
}

Index num_intrinsics_of_all(const RigProblem& problem) {
  Index count = 0;
  for (const auto& free : problem.free) count += static_cast<Index>(free.size());
  return count;
}

}  // namespace

bool solve(const RigProblem& problem, RigParameters& parameters) {
  RigParameters trial = parameters;
  ceres::Problem ceres_problem;
  build(problem, trial, ceres_problem);
  if (!minimize(ceres_problem, {})) return false;
  parameters = trial;
  return true;
}

std::optional<Evaluation> evaluate(const RigProblem& problem, RigParameters p) {
  ceres::Problem ceres_problem;
  build(problem, p, ceres_problem);
  const Index num_offsets =
      problem.deformation_sigma_m > 0.0 ? 3 * static_cast<Index>(p.corner_offsets_m.size()) : 0;
  return evaluate(ceres_problem, parameter_blocks(problem, p), num_offsets);
}

std::vector<std::string> rig_parameter_names(const RigProblem& problem, const RigParameters& p,
                                             const std::vector<std::string>& camera_names) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < p.cameras.size(); ++i) {
    const auto intrinsics = intrinsic_names(p.cameras[i].lens);
    for (int at : problem.free[i])
      names.push_back(camera_names[i] + "." + intrinsics[static_cast<std::size_t>(at)]);
  }
  for (std::size_t i = 1; i < p.cameras.size(); ++i)
    for (const char* part : {"rx", "ry", "rz", "tx", "ty", "tz"})
      names.push_back(camera_names[i] + "_from_" + camera_names.front() + "." + part);
  names.insert(names.end(), {"board.warp_x", "board.warp_y"});
  return names;
}

Eigen::MatrixXd left_rotation_jacobian(const RigProblem& problem, const RigParameters& p) {
  Index at = num_intrinsics_of_all(problem);
  const Index size = at + 6 * (static_cast<Index>(p.cameras.size()) - 1) + 2;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(size, size);
  for (std::size_t i = 1; i < p.cameras.size(); ++i, at += 6)
    jacobian.block<3, 3>(at, at) =
        left_jacobian(Eigen::Vector3d(p.cameras[i].camera_from_rig.data()));
  return jacobian;
}

std::array<double, 6> angle_axis_pose(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd rotation(pose.linear());
  const Eigen::Vector3d r = rotation.angle() * rotation.axis(), t = pose.translation();
  return {r.x(), r.y(), r.z(), t.x(), t.y(), t.z()};
}

RgbdParameters single_camera(const RigProblem& problem, const RigParameters& p,
                             std::size_t camera) {
  const RigCamera& c = p.cameras[camera];
  RgbdParameters single;
  single.lens = c.lens, single.color = c.intrinsics;
  single.board_warp_m = p.board_warp_m, single.corner_offsets_m = p.corner_offsets_m;
  single.camera_from_board.resize(problem.observations[camera].views.size());
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (const auto view = problem.frames[frame].views[camera])
      single.camera_from_board[*view] =
          angle_axis_pose(pose_of(c.camera_from_rig) * pose_of(p.rig_from_board[frame]));
  return single;
}

std::vector<Eigen::Vector2d> frame_residuals(const RigProblem& problem, const RigParameters& p,
                                             std::size_t frame) {
  std::vector<Eigen::Vector2d> all;
  for (std::size_t camera = 0; camera < p.cameras.size(); ++camera) {
    const auto view = problem.frames[frame].views[camera];
    if (!view) continue;
    for (const auto& residual :
         corner_residuals(problem.observations[camera], *view, single_camera(problem, p, camera)))
      all.push_back(residual / problem.corner_sigma_px[camera]);
  }
  return all;
}

}  // namespace touchtrace
