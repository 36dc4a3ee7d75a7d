#pragma once

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/calibration.h"
#include "engine/base/random.h"

namespace touchtrace {

/// Board views made by the camera model itself, without rendering: for tests and figures against
/// truth.
struct SimulatedBoards {
  BoardObservations clean;  ///< exact corners and, where asked, exact depth images
  RgbdParameters truth;
  double corner_sigma_px = 0.1,
         depth_sigma_at_1m = 0.003;  ///< of one pixel; grows with depth squared
};

/// A 320x240 camera with f = 305 px and `views` poses of a 9x6 board of 25 mm from 0.35 to 0.9 m.
SimulatedBoards simulated_boards(int views, bool with_depth);

/// The same views through a lens with k1 k2 p1 p2 k3.
SimulatedBoards with_distortion(SimulatedBoards boards, const std::array<double, 5>& distortion);

/// One noisy realisation; also the factory's depth intrinsics get their error of 0.5 %.
BoardObservations observe(const SimulatedBoards& boards, RandomStream& random);

/// Estimate minus truth, in the order of RgbdCalibration::parameters, for two or three radial
/// coefficients; rotation as log(R_estimate R_true').
Eigen::VectorXd errors(const RgbdCalibration& calibration, const RgbdParameters& truth);

/// The Cramer-Rao bound with k1 k2 p1 p2; the prior's information counts.
Eigen::MatrixXd cramer_rao_bound(const SimulatedBoards& boards);

}  // namespace touchtrace
