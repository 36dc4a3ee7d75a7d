#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "calib/board/chessboard.h"
#include "calib/camera/lens.h"

namespace touchtrace {

/// All unknowns of the joint problem. a_from_b maps coordinates in frame b to frame a; poses are
/// angle-axis [rad], then translation [m]. Frames: Camera, CalibrationTarget.
struct RgbdParameters {
  Lens lens = Radtan4{};
  std::array<double, max_intrinsics> color{};  ///< fx fy cx cy [px], coefficient_names(lens), zeros
  std::array<double, 2> board_warp_m{};        ///< coefficients of CalibrationTarget::warp_basis
  /// Per-corner deformation: offset from the warped board, in the board frame. Empty: none.
  std::vector<Eigen::Vector3d> corner_offsets_m;
  std::array<double, 6> depth_from_color{};
  std::array<double, 4> depth{};                     ///< fx fy cx cy [px]
  std::array<double, 2> depth_correction{1.0, 0.0};  ///< scale, offset [m]
  double depth_delay_s = 0.0;  ///< exposure of a depth image minus its time stamp
  std::vector<std::array<double, 6>> camera_from_board;  ///< [views] colour camera
};

/// Converts an angle-axis pose.
Eigen::Isometry3d pose_of(const std::array<double, 6>& pose);

/// Position [m] of a corner in the board frame, with warp and offset.
Eigen::Vector3d deformed_corner_m(const CalibrationTarget& board, int corner,
                                  const RgbdParameters& parameters);

/// Velocity of the board in the colour camera's frame while a view is taken.
struct BoardMotion {
  Eigen::Vector3d linear_m_s = Eigen::Vector3d::Zero();  ///< of the board frame's origin
  Eigen::Vector3d angular_rad_s = Eigen::Vector3d::Zero();
  double depth_after_color_s = 0.0;  ///< depth minus colour time stamp
};

/// Mean over a block of depth pixels on the board.
struct DepthSample {
  std::size_t view;
  Eigen::Vector2d pixel;  ///< mean position in the depth image
  double measured_m, sigma_m;
  Eigen::Vector2d warp_basis =
      Eigen::Vector2d::Zero();  ///< CalibrationTarget::warp_basis at the sample
  BoardMotion motion = {};
};

/// Gaussian priors. An infinite sigma: no prior.
struct Prior {
  std::array<double, max_intrinsics> color_mean{}, color_sigma{};
  double warp_sigma_m = 0.0;
  double deformation_sigma_m = 0.0;  ///< of corner_offsets_m in each direction; 0: no offsets
  std::array<double, 4> depth_mean{}, depth_sigma{};
  std::array<double, 6> pose_sigma{};        ///< of depth_from_color about the identity
  std::array<double, 2> correction_sigma{};  ///< about scale 1, offset 0
  double delay_sigma_s = 0.0;                ///< about 0
};

/// The other parameters are constant.
enum class Estimated { everything, color_camera, board_poses, depth_camera };

/// Robust nonlinear least squares over corners, depth samples and priors:
///     sum |corner - project(camera_from_board X)|^2 / corner_sigma_px^2
///   + sum ((board's depth along the pixel's ray - offset) / scale - measured)^2 / sigma_m^2
///   + priors.
/// X: deformed_corner_m(). The prior of the offsets has zero mean, which keeps the board's size.
/// Depth ignores the offsets, which are far below its noise. Its residual is in measured depth, so
/// that noise does not bias the scale.
struct BoardProblem {
  const BoardObservations& observations;
  std::vector<bool> used;            ///< [views]
  std::vector<DepthSample> samples;  ///< empty: colour camera only
  Prior prior;
  std::vector<int> free_color{0, 1, 2, 3};  ///< estimated entries of RgbdParameters::color, sorted
  bool free_delay = false;                  ///< estimate depth_delay_s; else constant
  double corner_sigma_px = 1.0;
  double loss_sigmas = 3.0;  ///< threshold of the Huber loss
  Estimated estimated = Estimated::everything;
  int max_iterations = 500;  ///< the Huber loss makes narrow valleys that need many
  double cost_tolerance = 1e-10, parameter_tolerance = 1e-10;  ///< relative
  int num_threads = 1;  ///< changes the result only by rounding
};

/// True if corner_offsets_m are estimated; then there is one for each corner of the board.
inline bool has_free_deformation(const BoardProblem& problem) {
  return problem.prior.deformation_sigma_m > 0.0;
}

/// Solves, starting from `parameters`. Returns false, and leaves them unchanged, if Ceres does not
/// converge or the cost is not finite.
bool solve(const BoardProblem& problem, RgbdParameters& parameters);

/// Measured minus projected [px], for each detected corner of the view. Infinite where the lens
/// cannot project.
std::vector<Eigen::Vector2d> corner_residuals(const BoardObservations& observations,
                                              std::size_t view, const RgbdParameters& parameters);
/// Model minus measurement, in measured depth [m].
double depth_residual(const DepthSample& sample, const RgbdParameters& parameters);
/// True depth [m] of the board along the ray of a depth pixel.
double board_depth_m(const DepthSample& sample, const RgbdParameters& parameters);

/// Names of the estimated parameters except for poses and offsets, in the order of covariance().
std::vector<std::string> parameter_names(const BoardProblem& problem, const Lens& lens);
/// Derivative [size, size] of parameter_names(), with rotations perturbed from the left, by the
/// angle-axis increments that Ceres uses.
Eigen::MatrixXd left_rotation_jacobian(const BoardProblem& problem, const RgbdParameters& p,
                                       Eigen::Index size);
/// Information matrix J'J at `parameters`, with corner offsets marginalised out. Order:
/// parameter_names(), then the poses of the used views. Empty if it cannot be evaluated.
Eigen::MatrixXd information(const BoardProblem& problem, RgbdParameters parameters);
/// Inverse of an information matrix, marginalised to its first `size` parameters. Empty if
/// singular.
Eigen::MatrixXd marginal_covariance(const Eigen::MatrixXd& information, Eigen::Index size);
/// Covariance of parameter_names() at `parameters`. Rotations are perturbed from the left.
Eigen::MatrixXd covariance(const BoardProblem& problem, const RgbdParameters& parameters);

/// Covariance of an estimate, as C S C: C is the inverse information at the estimate, S the mean
/// information at 8 points drawn from N(estimate, C). Noisy board tilts look like larger tilts, so
/// that the information at the estimate is too large; S measures that excess. NEES 1.28 -> 1.11 at
/// 2 px noise in 320x240. Deterministic. Empty if singular.
Eigen::MatrixXd covariance_of_estimate(const BoardProblem& problem, const RgbdParameters& estimate);

}  // namespace touchtrace
