#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "calib/board/chessboard.h"
#include "calib/camera/lens.h"

namespace touchtrace {

/// All unknowns of the joint problem. Poses are angle-axis [rad], then translation [m].
struct RgbdParameters {
  Lens lens = Radtan4{};
  std::array<double, max_intrinsics> color{};  ///< fx fy cx cy [px], coefficient_names(lens), zeros
  std::array<double, 2> board_warp_m{};        ///< of Chessboard::warp_shape
  /// How far off each corner of the warped board was printed, in the board's frame; empty: not.
  std::vector<Eigen::Vector3d> board_offsets_m;
  std::array<double, 6> depth_from_color{};
  std::array<double, 4> depth{};                     ///< fx fy cx cy [px]
  std::array<double, 2> depth_correction{1.0, 0.0};  ///< scale, offset [m]
  double depth_delay_s = 0.0;  ///< depth images show what is this much later than they are stamped
  std::vector<std::array<double, 6>> camera_from_board;  ///< one for each view
};

/// The rigid motion of an angle-axis and a translation.
Eigen::Isometry3d pose_of(const std::array<double, 6>& pose);

/// Where a corner of the board is [m]: it is warped, and printed not quite where it should be.
Eigen::Vector3d corner_on_board(const Chessboard& board, int corner,
                                const RgbdParameters& parameters);

/// How the board moves while a view is taken, in the colour camera's frame.
struct BoardMotion {
  Eigen::Vector3d linear_m_s = Eigen::Vector3d::Zero();  ///< of the board's origin
  Eigen::Vector3d angular_rad_s = Eigen::Vector3d::Zero();
  double depth_after_color_s = 0.0;  ///< by the stamps
};

/// The mean of a few neighbouring depth pixels that lie on the board.
struct DepthSample {
  std::size_t view;
  Eigen::Vector2d pixel;
  double measured_m, sigma_m;
  Eigen::Vector2d warp_shape = Eigen::Vector2d::Zero();  ///< Chessboard::warp_shape there
  BoardMotion motion = {};
};

/// What is known before a measurement: mean and standard deviation. An infinite deviation knows
/// nothing.
struct Prior {
  std::array<double, max_intrinsics> color_mean{}, color_sigma{};
  double warp_sigma_m = 0.0;
  double print_sigma_m = 0.0;  ///< of board_offsets_m in each direction; 0: there are none
  std::array<double, 4> depth_mean{}, depth_sigma{};
  std::array<double, 6> pose_sigma{};        ///< of depth_from_color, about the identity
  std::array<double, 2> correction_sigma{};  ///< about scale 1, offset 0
  double delay_sigma_s = 0.0;
};

/// One least-squares problem over corners, depth samples and priors:
///     sum |corner - project(camera_from_board X)|^2 / corner_sigma_px^2
///   + sum ((board's depth along the pixel's ray - offset) / scale - measured)^2 / sigma_m^2 +
///   priors.
/// X lies on the warped board, off by its corner's offset where the print is free. Those have the
/// mean zero, so that the board keeps its size. They are far below the noise of the depth, whose
/// board is warped only. The depth's error stands in measured depth, so that its noise does not
/// bias the scale.
struct BoardProblem {
  const BoardObservations& observations;
  std::vector<bool> used;            ///< [views]
  std::vector<DepthSample> samples;  ///< empty: the depth camera is left out
  Prior prior;
  std::vector<int> free_color{0, 1, 2, 3};  ///< free entries of RgbdParameters::color, increasing
  bool free_delay = false;                  ///< of the depth images; else it stays 0
  double corner_sigma_px = 1.0;
  double loss_sigmas = 3.0;   ///< Huber's threshold
  bool depth_only = false;    ///< colour camera, board and its poses stay as they are
  int most_iterations = 500;  ///< Huber's kinks make narrow valleys long
  double cost_tolerance = 1e-10, parameter_tolerance = 1e-10;  ///< relative
  bool fixed_camera = false;  ///< only the board's poses move; without depth
};

/// True if the corners' offsets are unknowns; then there is one for each corner.
inline bool print_is_free(const BoardProblem& problem) { return problem.prior.print_sigma_m > 0.0; }

/// Solves from `parameters`. False if Ceres did not converge or a number is not finite.
bool solve(const BoardProblem& problem, RgbdParameters& parameters);

/// Pixels, measured minus projected: [corners].
std::vector<Eigen::Vector2d> corner_residuals(const BoardObservations& observations,
                                              std::size_t view, const RgbdParameters& parameters);
/// Metres of measured depth, model minus measured.
double depth_residual(const DepthSample& sample, const RgbdParameters& parameters);
/// Depth [m] of the board along the ray of a depth pixel.
double board_depth_m(const DepthSample& sample, const RgbdParameters& parameters);

/// Names of the parameters that covariance() speaks of, in its order.
std::vector<std::string> parameter_names(const BoardProblem& problem, const Lens& lens);
/// J'J at `parameters`, of parameter_names() and behind them the poses, the board's offsets
/// marginalised out; empty if it cannot be evaluated.
Eigen::MatrixXd information(const BoardProblem& problem, RgbdParameters parameters);
/// Inverse of an information, all but its first `size` marginalised out; empty if it is singular.
Eigen::MatrixXd marginal_covariance(const Eigen::MatrixXd& information, Eigen::Index size);
/// That of parameter_names() at `parameters`, rotations from the left.
Eigen::MatrixXd covariance(const BoardProblem& problem, const RgbdParameters& parameters);

/// The covariance of an estimate, from the information J'J where the estimate is. Noisy tilts of
/// the boards make that information too large: they look like more tilt than there is. So it is
/// taken once more as a mean over where the estimate might as well have been, and its excess S
/// there goes off: C S C for C = inverse of the information (NEES 1.28 -> 1.11 at 2 px in 320x240).
/// Deterministic.
Eigen::MatrixXd covariance_of_estimate(const BoardProblem& problem, const RgbdParameters& estimate);

}  // namespace touchtrace
