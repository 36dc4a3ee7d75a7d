#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/normal_equations.h"
#include "calib/rig/frames.h"

namespace touchtrace {

/// A camera of a rig. Poses: as in RgbdParameters.
struct RigCamera {
  Lens lens = Radtan4{};
  std::array<double, max_intrinsics> intrinsics{};  ///< fx fy cx cy [px], coefficient_names(lens)
  std::array<double, 6> camera_from_rig{};          ///< identity for the first camera
};

/// All unknowns of a rig. The rig's frame is that of its first camera.
struct RigParameters {
  std::vector<RigCamera> cameras;
  std::array<double, 2> board_warp_m{};           ///< coefficients of CalibrationTarget::warp_basis
  std::vector<Eigen::Vector3d> corner_offsets_m;  ///< [corners of the board]; 0 if not estimated
  std::vector<std::array<double, 6>> rig_from_board;  ///< [frames]
};

/// Robust nonlinear least squares over the corners of all cameras and priors:
///     sum |corner - project(camera_from_rig rig_from_board X)|^2 / corner_sigma_px^2 + priors.
struct RigProblem {
  const std::vector<BoardObservations>& observations;  ///< [cameras] views of one board
  std::vector<RigFrame> frames = {};
  std::vector<bool> used = {};               ///< [frames]
  std::vector<Prior> priors = {};            ///< [cameras] color_prior()
  std::vector<std::vector<int>> free = {};   ///< [cameras] as BoardProblem::free_color
  std::vector<double> corner_sigma_px = {};  ///< [cameras] noise of one corner coordinate
  double deformation_sigma_m = 0.0;          ///< as Prior::deformation_sigma_m
  double loss_sigmas = 3.0;                  ///< threshold of the Huber loss
  bool fixed_rig = false;                    ///< estimates only rig_from_board
};

/// Solves, starting from `parameters`. Returns false, and leaves them unchanged, if Ceres does not
/// converge or the cost is not finite.
bool solve(const RigProblem& problem, RigParameters& parameters);

/// Residuals and Jacobian. Parameters: rig_parameter_names(), then the poses of the used frames,
/// then the offsets. nullopt if a residual cannot be evaluated.
std::optional<Evaluation> evaluate(const RigProblem& problem, RigParameters parameters);

/// Names of the estimated parameters without poses of the board and offsets: for each camera
/// NAME.fx .. NAME.cy and its coefficients; NAME_from_FIRST.rx .. tz for each but the first; and
/// board.warp_x, board.warp_y.
std::vector<std::string> rig_parameter_names(const RigProblem& problem, const RigParameters& p,
                                             const std::vector<std::string>& camera_names);

/// Jacobian of the parameters of rig_parameter_names(), rotations perturbed from the left, with
/// respect to the angle-axis parameters.
Eigen::MatrixXd left_rotation_jacobian(const RigProblem& problem, const RigParameters& p);

/// Angle-axis, then translation: the inverse of pose_of().
std::array<double, 6> angle_axis_pose(const Eigen::Isometry3d& pose);

/// Parameters of one camera, with its poses in the views that belong to a frame.
RgbdParameters single_camera(const RigProblem& problem, const RigParameters& p, std::size_t camera);

/// Residuals of all views of a frame, divided by corner_sigma_px.
std::vector<Eigen::Vector2d> frame_residuals(const RigProblem& problem, const RigParameters& p,
                                             std::size_t frame);

}  // namespace touchtrace
