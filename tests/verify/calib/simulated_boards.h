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
  double print_sigma_m = 0.0;        ///< of truth.board_offsets_m
};

/// A 4:3 camera with a field of 55 degrees across (f = 305 px at 320x240), radtan4, and `views`
/// poses of a 9x6 board of 25 mm from 0.35 to 0.9 m.
SimulatedBoards simulated_boards(int views, bool with_depth, int width = 320);

/// A fisheye of about 150 degrees across, 640x480, and `views` poses up to 60 degrees to the side.
SimulatedBoards simulated_fisheye_boards(int views);

/// `views` pairs of views, a video's frame apart, of a board that moves; the depth images show what
/// is `delay_s` later than their stamps say.
SimulatedBoards simulated_moving_boards(int views, double delay_s);

/// The same views through another lens.
SimulatedBoards seen_through(SimulatedBoards boards, const Lens& lens,
                             const std::array<double, max_coefficients>& coefficients);
/// The same views of a board that is not flat (colour only).
SimulatedBoards warped(SimulatedBoards boards, const std::array<double, 2>& warp_m);

/// The same views of a board whose corners are off by `sigma_m` in each direction.
SimulatedBoards misprinted(SimulatedBoards boards, double sigma_m, RandomStream& random);

/// One noisy realisation; also the factory's depth intrinsics get their error of 0.5 %.
BoardObservations observe(const SimulatedBoards& boards, RandomStream& random);

/// Estimate minus truth, in the order of RgbdCalibration::parameters; rotation as log(R_estimate
/// R_true'). The lens must be the truth's.
Eigen::VectorXd errors(const RgbdCalibration& calibration, const RgbdParameters& truth);

/// The Cramer-Rao bound with all coefficients of the truth's lens; the prior's information counts.
Eigen::MatrixXd cramer_rao_bound(const SimulatedBoards& boards);

}  // namespace touchtrace
