#pragma once

#include <ceres/crs_matrix.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

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

/// Residuals and their Jacobian, in the order of NormalEquations.
struct Evaluation {
  ceres::CRSMatrix jacobian;
  std::vector<double> residuals;
  Eigen::Index num_offsets = 0;  ///< 3 n

  Eigen::Index num_parameters() const { return jacobian.num_cols - num_offsets; }
};

/// Evaluates at `parameters`, whose blocks `ceres_problem` refers to. nullopt if a residual cannot
/// be evaluated.
std::optional<Evaluation> evaluate(CeresProblem& ceres_problem, const BoardProblem& problem,
                                   RgbdParameters& parameters);

/// The same for any problem: `blocks` are its parameters, each observation's pose and then the
/// offsets last; `num_offsets`: 3 n, or 0.
std::optional<Evaluation> evaluate(ceres::Problem& problem, std::vector<double*> blocks,
                                   Eigen::Index num_offsets, int num_threads = 1);

/// Sums over all residuals.
NormalEquations normal_equations(const Evaluation& evaluation);
/// Sums over the residuals that do not depend on one view's pose, whose six parameters begin at
/// `first_pose_parameter`. J'J of that pose is the identity.
NormalEquations normal_equations_without_view(const Evaluation& evaluation,
                                              Eigen::Index first_pose_parameter);

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
