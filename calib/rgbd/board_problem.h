#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// All unknowns of the joint problem. Poses are angle-axis [rad], then translation [m].
struct RgbdParameters {
  std::array<double, 9> color{};  ///< fx fy cx cy [px], k1 k2 p1 p2 k3
  std::array<double, 6> depth_from_color{};
  std::array<double, 4> depth{};                         ///< fx fy cx cy [px]
  std::array<double, 2> depth_correction{1.0, 0.0};      ///< scale, offset [m]
  std::vector<std::array<double, 6>> camera_from_board;  ///< one for each view
};

/// The rigid motion of an angle-axis and a translation.
Eigen::Isometry3d pose_of(const std::array<double, 6>& pose);

/// The mean of a few neighbouring depth pixels that lie on the board.
struct DepthSample {
  std::size_t view;
  Eigen::Vector2d pixel;
  double measured_m, sigma_m;
};

/// What is known before a measurement: mean and standard deviation. An infinite deviation knows
/// nothing.
struct Prior {
  std::array<double, 9> color_mean{}, color_sigma{};
  std::array<double, 4> depth_mean{}, depth_sigma{};
  std::array<double, 6> pose_sigma{};        ///< of depth_from_color, about the identity
  std::array<double, 2> correction_sigma{};  ///< about scale 1, offset 0
};

/// One least-squares problem over corners, depth samples and priors:
///     sum |corner - project(camera_from_board X)|^2 / corner_sigma_px^2
///   + sum ((plane depth along the pixel's ray - offset) / scale - measured)^2 / sigma_m^2 +
///   priors.
/// The depth's error stands in measured depth, so that its noise does not bias the scale.
struct BoardProblem {
  const BoardObservations& observations;
  std::vector<bool> used;            ///< [views]
  std::vector<DepthSample> samples;  ///< empty: the depth camera is left out
  Prior prior;
  std::vector<int> free_color{0, 1, 2, 3};  ///< free entries of RgbdParameters::color, increasing
  double corner_sigma_px = 1.0;
  double loss_sigmas = 3.0;  ///< Huber's threshold
  bool depth_only = false;   ///< colour camera and board poses stay as they are
};

/// Solves from `parameters`. False if Ceres did not converge or a number is not finite.
bool solve(const BoardProblem& problem, RgbdParameters& parameters);

/// Pixels, measured minus projected: [corners].
std::vector<Eigen::Vector2d> corner_residuals(const BoardObservations& observations,
                                              std::size_t view, const RgbdParameters& parameters);
/// Metres of measured depth, model minus measured.
double depth_residual(const DepthSample& sample, const RgbdParameters& parameters);
/// Depth [m] of the board's plane along the ray of a depth pixel.
double plane_depth_m(const Eigen::Vector2d& pixel, std::size_t view,
                     const RgbdParameters& parameters);

/// Names of the parameters that covariance() speaks of, in its order.
std::vector<std::string> parameter_names(const BoardProblem& problem);
/// Inverse of J'J at the solution, board poses marginalised out; empty if it is singular.
Eigen::MatrixXd covariance(const BoardProblem& problem, RgbdParameters parameters);

}  // namespace touchtrace
