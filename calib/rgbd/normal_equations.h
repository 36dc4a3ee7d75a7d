#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// J'J, J'r and r'r of a BoardProblem: of parameter_names() and the poses, p in all, and of the
/// offsets of the board's corners, if those are free. What is measured has at most one offset in
/// it, so that of their J'J only squares differ from 0.
struct NormalEquations {
  Eigen::MatrixXd parameters;  ///< [p, p]
  Eigen::MatrixXd across;      ///< [p, 3 corners]
  Eigen::Matrix3Xd offsets;    ///< [3, 3 corners]: a square for each
  Eigen::VectorXd parameters_gradient, offsets_gradient;
  double squares = 0.0;
};

/// At `parameters`, over whose blocks `ceres_problem` is; empty if it cannot be evaluated there.
NormalEquations normal_equations(const ceres::Problem& ceres_problem, const BoardProblem& problem,
                                 RgbdParameters& parameters);

/// The same problem once its offsets are where they fit best, `weight` times their squares added.
struct Eliminated {
  Eigen::MatrixXd parameters;
  Eigen::VectorXd gradient;
  double squares = 0.0;
  double log_determinant = 0.0;  ///< of the offsets' J'J with the weight on its diagonal
};

Eliminated without_offsets(const NormalEquations& equations, double weight = 0.0);

}  // namespace touchtrace
