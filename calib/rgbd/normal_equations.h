#pragma once

#include <Eigen/Core>

#include "calib/rgbd/board_problem.h"
#include "calib/rgbd/ceres_problem.h"

namespace touchtrace {

/// Normal equations J'J, J'r, r'r of a BoardProblem, in two groups: p parameters (parameter_names()
/// and the poses of the used views) and the offsets of the board's n corners, if these are free. A
/// residual depends on at most one offset, so that J'J of the offsets is block-diagonal.
struct NormalEquations {
  Eigen::MatrixXd parameters;  ///< [p, p]
  Eigen::MatrixXd coupling;    ///< [p, 3 n]
  Eigen::Matrix3Xd offsets;    ///< [3, 3 n] diagonal blocks
  Eigen::VectorXd parameters_gradient, offsets_gradient;
  double squares = 0.0;  ///< r'r
};

/// Evaluates at `parameters`, whose blocks `ceres_problem` refers to. Empty if a residual cannot be
/// evaluated.
NormalEquations normal_equations(CeresProblem& ceres_problem, const BoardProblem& problem,
                                 RgbdParameters& parameters);

/// Normal equations after eliminating the offsets (Schur complement).
struct ReducedEquations {
  Eigen::MatrixXd parameters;
  Eigen::VectorXd gradient;
  double squares = 0.0;
  double log_determinant = 0.0;  ///< of the offsets' J'J + weight I
};

/// `weight`: added to the diagonal of the offsets' J'J.
ReducedEquations eliminate_offsets(const NormalEquations& equations, double weight = 0.0);

}  // namespace touchtrace
