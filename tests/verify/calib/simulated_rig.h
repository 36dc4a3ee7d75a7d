#pragma once

#include "calib/rig/calibrate_rig.h"
#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {

/// Cameras fixed to each other that see one board, and their ground truth. Views of different
/// cameras with the same name are simultaneous.
struct SimulatedRig {
  std::vector<std::string> names;
  std::vector<SimulatedBoards> cameras;
  std::vector<Eigen::Isometry3d> camera_from_rig;
};

/// Cameras of simulated_boards() at 640x480, 80 mm apart and turned towards each other by 1.7
/// degrees. `frames`: views of the first camera; the other ones see the board in most of them.
SimulatedRig simulated_rig(int frames, int cameras = 2);

/// Draws the board's warp and the cameras' tangential distortion from their priors.
SimulatedRig draw_from_prior(SimulatedRig rig, RandomStream& random);

/// Adds noise to the corners.
std::vector<RigInput> observe(const SimulatedRig& rig, RandomStream& random);

/// Estimate minus truth of the pose of a camera: log(R_estimate R_truth') [rad], translation [m].
Eigen::Matrix<double, 6, 1> pose_error(const RigCalibration& rig, const SimulatedRig& truth,
                                       std::size_t camera);

/// Mean of e' C^-1 e / 6 over the second camera's pose in `runs` simulated rigs.
double rig_pose_nees(const SimulatedRig& rig, int runs);

}  // namespace touchtrace
