#include "tests/verify/calib/simulated_rig.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "calib/rgbd/prior.h"
#include "calib/rgbd/rotation.h"
#include "calib/rig/rig_problem.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr int width_px = 640;
constexpr double baseline_m = 0.08, convergence_rad = 0.03;

/// The pose of the camera with this index, in a row along x.
Eigen::Isometry3d pose_in_row(int camera) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_matrix(camera * Eigen::Vector3d(0.01, convergence_rad, -0.02));
  pose.translation() = camera * Eigen::Vector3d(-baseline_m, 0.002, 0.004);
  return pose;
}

std::array<double, max_coefficients> coefficients(const RgbdParameters& p) {
  std::array<double, max_coefficients> values;
  std::copy_n(p.color.begin() + 4, max_coefficients, values.begin());
  return values;
}

/// The boards as another camera sees them.
SimulatedBoards seen_from(const SimulatedBoards& first, const Eigen::Isometry3d& camera_from_rig) {
  SimulatedBoards boards = first;
  for (auto& pose : boards.truth.camera_from_board)
    pose = angle_axis_pose(camera_from_rig * pose_of(pose));
  return with_lens_coefficients(boards, boards.truth.lens, coefficients(boards.truth));
}

bool is_in_image(const BoardView& view, const BoardObservations& o) {
  return std::ranges::all_of(view.corners_px, [&](const Eigen::Vector2d& c) {
    return c.x() >= 0.0 && c.y() >= 0.0 && c.x() <= o.width - 1.0 && c.y() <= o.height - 1.0;
  });
}

void remove_views_outside(SimulatedBoards& boards) {
  SimulatedBoards kept = boards;
  kept.clean.views.clear(), kept.truth.camera_from_board.clear();
  for (std::size_t view = 0; view < boards.clean.views.size(); ++view) {
    if (!is_in_image(boards.clean.views[view], boards.clean)) continue;
    kept.clean.views.push_back(boards.clean.views[view]);
    kept.truth.camera_from_board.push_back(boards.truth.camera_from_board[view]);
  }
  boards = std::move(kept);
}

}  // namespace

SimulatedRig simulated_rig(int frames, int cameras) {
  SimulatedRig rig;
  const SimulatedBoards first = simulated_boards(frames, false, width_px);
  for (int i = 0; i < cameras; ++i) {
    rig.names.push_back("cam" + std::to_string(i));
    rig.camera_from_rig.push_back(pose_in_row(i));
    rig.cameras.push_back(seen_from(first, rig.camera_from_rig.back()));
    remove_views_outside(rig.cameras.back());
  }
  return rig;
}

SimulatedRig draw_from_prior(SimulatedRig rig, RandomStream& random) {
  const double warp_m = warp_sigma_m(rig.cameras.front().clean.board);
  const std::array<double, 2> warp{random.normal(0.0, warp_m), random.normal(0.0, warp_m)};
  for (auto& boards : rig.cameras) {
    auto lens = coefficients(boards.truth);
    for (int i : {2, 3}) lens[std::size_t(i)] = random.normal(0.0, tangential_sigma);
    boards = with_lens_coefficients(with_warp(boards, warp), boards.truth.lens, lens);
  }
  return rig;
}

std::vector<RigInput> observe(const SimulatedRig& rig, RandomStream& random) {
  std::vector<RigInput> inputs;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i)
    inputs.push_back({rig.names[i], observe(rig.cameras[i], random)});
  return inputs;
}

Eigen::Matrix<double, 6, 1> pose_error(const RigCalibration& rig, const SimulatedRig& truth,
                                       std::size_t camera) {
  const Eigen::Isometry3d &estimate = rig.camera_from_rig[camera],
                          &expected = truth.camera_from_rig[camera];
  const Eigen::AngleAxisd rotation(estimate.linear() * expected.linear().transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << rotation.angle() * rotation.axis(), estimate.translation() - expected.translation();
  return error;
}

double rig_pose_nees(const SimulatedRig& rig, int runs) {
  Progress progress("simulated rigs", static_cast<std::uint64_t>(runs));
  double nees = 0.0;
  for (int run = 0; run < runs; ++run, progress.advance()) {
    RandomStream random(static_cast<std::uint64_t>(run), "simulated rig");
    const auto inputs = observe(draw_from_prior(rig, random), random);
    const RigCalibration c = calibrate_rig(inputs, {.lenses = {"radtan4"}});
    const auto error = pose_error(c, rig, 1);
    nees += error.dot(pose_covariance(c, 1).ldlt().solve(error)) / (6.0 * runs);
  }
  return nees;
}

}  // namespace touchtrace
