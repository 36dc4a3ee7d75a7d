#pragma once

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/calibration.h"
#include "calib/rgbd/lens_choice.h"
#include "engine/base/random.h"

namespace touchtrace {

/// Board views computed with the camera model, without rendering, and their ground truth.
struct SimulatedBoards {
  BoardObservations clean;  ///< noise-free corners and, if requested, depth images
  RgbdParameters truth;
  double corner_sigma_px = 0.1;
  double depth_sigma_at_1m = 0.003;  ///< of one pixel; proportional to depth squared
  double deformation_sigma_m = 0.0;  ///< of truth.corner_offsets_m
  std::string fitted_lens = {};      ///< lens_choice() to fit; empty: that of truth.lens
};

/// Candidate lens that the boards are calibrated with.
LensChoice fitted_lens(const SimulatedBoards& boards);

/// 4:3 camera with a horizontal field of view of 55 degrees (f = 305 px at 320x240) and radtan4;
/// `views` poses of a 9x6 board of 25 mm squares at 0.35 to 0.9 m.
SimulatedBoards simulated_boards(int views, bool with_depth, int width = 320);

/// Fisheye with a horizontal field of view of about 150 degrees, 640x480; `views` poses up to 60
/// degrees off the optical axis.
SimulatedBoards simulated_fisheye_boards(int views);

/// Moving board: 2 * `views` views, in pairs 1/30 s apart. Depth images are exposed `delay_s` after
/// their time stamps.
SimulatedBoards simulated_moving_boards(int views, double delay_s);

/// Replaces the lens; the poses stay.
SimulatedBoards with_lens_coefficients(SimulatedBoards boards, const Lens& lens,
                                       const std::array<double, max_coefficients>& coefficients);
/// Warps the board (colour only).
SimulatedBoards with_warp(SimulatedBoards boards, const std::array<double, 2>& warp_m);

/// Adds offsets N(0, sigma_m^2) to the corners of the board in each direction.
SimulatedBoards with_deformed_target(SimulatedBoards boards, double sigma_m, RandomStream& random);

/// Adds noise to corners and depth, and the factory's error of 0.5 % to the depth intrinsics.
BoardObservations observe(const SimulatedBoards& boards, RandomStream& random);
/// With noise from the random stream of this seed.
BoardObservations observe(const SimulatedBoards& boards, std::uint64_t seed);

/// Estimate minus truth, in the order of RgbdCalibration::parameters. Rotation: log(R_estimate
/// R_truth'). The calibration must have the lens of the truth.
Eigen::VectorXd errors(const RgbdCalibration& calibration, const RgbdParameters& truth);

/// Cramer-Rao bound of the parameters of fitted_lens() and the rest, with the information of the
/// priors.
Eigen::MatrixXd cramer_rao_bound(const SimulatedBoards& boards);

}  // namespace touchtrace
