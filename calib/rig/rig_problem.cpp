#include "calib/rig/rig_problem.h"

#include <ceres/ceres.h>

#include <algorithm>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/cost_functions.h"
#include "calib/rgbd/rotation.h"

namespace touchtrace {
namespace {

using Eigen::Index;

template <class L>
constexpr int num_intrinsics = 4 + static_cast<int>(L::coefficients.size());

/// Reprojection error of one corner through the lens L: (projected - measured) / sigma [2].
template <class L>
struct RigCornerError {
  Eigen::Vector3d flat_m;
  Eigen::Vector2d warp_basis, measured_px;
  double sigma_px;

  template <class T>
  bool operator()(const T* intrinsics, const T* camera_from_rig, const T* rig_from_board,
                  const T* warp_m, const T* offset_m, T* residual) const {
    Vector3<T> on_board = flat_m.cast<T>() + Eigen::Map<const Vector3<T>>(offset_m);
    on_board.z() += T(warp_basis.x()) * warp_m[0] + T(warp_basis.y()) * warp_m[1];
    Vector3<T> in_rig, p;
    ceres::AngleAxisRotatePoint(rig_from_board, on_board.data(), in_rig.data());
    in_rig += Eigen::Map<const Vector3<T>>(rig_from_board + 3);
    ceres::AngleAxisRotatePoint(camera_from_rig, in_rig.data(), p.data());
    p += Eigen::Map<const Vector3<T>>(camera_from_rig + 3);
    if (!L::can_project(p)) return false;
    const Vector2<T> pixel = project_point<L>(intrinsics, p);
    for (int i = 0; i < 2; ++i) residual[i] = (pixel[i] - T(measured_px[i])) / T(sigma_px);
    return true;
  }
};

template <class L>
void add_view(const RigProblem& problem, std::size_t frame, std::size_t camera, RigParameters& p,
              ceres::LossFunction* loss, ceres::Problem& ceres_problem) {
  const BoardObservations& o = problem.observations[camera];
  const BoardView& view = o.views[*problem.frames[frame].views[camera]];
  RigCamera& c = p.cameras[camera];
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const int corner = view.corner_id(i);
    const Eigen::Vector3d flat_m = o.board.corner_m(corner);
    ceres_problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RigCornerError<L>, 2, num_intrinsics<L>, 6, 6, 2, 3>(
            new RigCornerError<L>{flat_m, o.board.warp_basis(flat_m.head<2>()), view.corners_px[i],
                                  problem.corner_sigma_px[camera]}),
        loss, c.intrinsics.data(), c.camera_from_rig.data(), p.rig_from_board[frame].data(),
        p.board_warp_m.data(), p.corner_offsets_m[std::size_t(corner)].data());
  }
}

template <int N>
ceres::CostFunction* prior_of(const PriorError<N>& prior) {
  return new ceres::AutoDiffCostFunction<PriorError<N>, N, N>(new PriorError<N>(prior));
}

template <class L>
void add_camera(const RigProblem& problem, std::size_t camera, RigParameters& p,
                ceres::LossFunction* loss, ceres::Problem& ceres_problem) {
  constexpr int size = num_intrinsics<L>;
  RigCamera& c = p.cameras[camera];
  PriorError<size> prior;
  std::copy_n(problem.priors[camera].color_mean.begin(), size, prior.mean.begin());
  std::copy_n(problem.priors[camera].color_sigma.begin(), size, prior.sigma.begin());
  ceres_problem.AddResidualBlock(prior_of(prior), nullptr, c.intrinsics.data());
  for (std::size_t frame = 0; frame < problem.frames.size(); ++frame)
    if (problem.used[frame] && problem.frames[frame].views[camera])
      add_view<L>(problem, frame, camera, p, loss, ceres_problem);
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
  ceres_problem.AddResidualBlock(prior_of<2>({{}, {warp_m, warp_m}}), nullptr,
                                 p.board_warp_m.data());
  for (auto& offset : p.corner_offsets_m) {
    if (offset_m > 0.0)
      ceres_problem.AddResidualBlock(prior_of<3>({{}, {offset_m, offset_m, offset_m}}), nullptr,
                                     offset.data());
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
    with_lens(p.cameras[camera].lens,
              [&](auto l) { add_camera<decltype(l)>(problem, camera, p, loss, ceres_problem); });
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
