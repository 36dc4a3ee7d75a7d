#pragma once

#include <string>
#include <vector>

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/normal_equations.h"

namespace touchtrace {

/// Covariance of an estimate whose independent observations are views, not corners: the corners of
/// a view err together, because lens model, board and detection are not perfect.
struct ViewCovariance {
  Eigen::MatrixXd independent;  ///< of parameter_names(), if corners were independent
  Eigen::MatrixXd by_views;     ///< of parameter_names()
  /// Standard deviations over those of independent corners, root mean square over all parameters.
  double inflation = 1.0;
};

/// Second moment of what the views contribute to an estimate, shrunk (Ledoit and Wolf, Journal of
/// Multivariate Analysis 2004) because there are hardly more views than parameters. The target is
/// diagonal, with the mean square of a block of parameters: errors that corners share reach focal
/// lengths, distortion and board by different amounts.
///
/// `contributions` [parameters, views] has the covariance I / views if corners are independent.
/// `block_sizes`: numbers of consecutive parameters. A block is divided by 1 - r, where r is the
/// relative variance of the result in one direction: the mean of the inverse of a gamma variate
/// exceeds the inverse of its mean by that, so that few views would make squared errors over their
/// estimated variance too large.
Eigen::MatrixXd shrunk_second_moment(const Eigen::MatrixXd& contributions,
                                     const std::vector<Eigen::Index>& block_sizes);

/// Cluster-robust covariance with bias reduction (Bell and McCaffrey, Survey Methodology 2002,
/// CR2), from Gauss-Newton steps that leave one view out. `independent`: covariance for independent
/// corners, which the result is relative to and not below. It is the result if the views'
/// contributions do not exceed those of independent corners by three standard errors, if there are
/// fewer than four views, or if a step cannot be computed.
ViewCovariance view_covariance(const BoardProblem& problem, const RgbdParameters& parameters,
                               const Eigen::MatrixXd& independent);
/// The same for any problem. Its parameters are those of interest, with names WHOSE.NAME, to which
/// the square matrix `left_rotations` is applied, then six for the pose of each independent
/// observation.
ViewCovariance view_covariance(const Evaluation& evaluation,
                               const std::vector<std::string>& parameters,
                               const Eigen::MatrixXd& left_rotations,
                               const Eigen::MatrixXd& independent);

}  // namespace touchtrace
