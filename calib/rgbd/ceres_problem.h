#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include <memory>
#include <span>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Rotations of all views at Ceres' current evaluation point. They are computed once for all
/// corners of a view, by the callback; cost functions only read them, from any number of threads.
class ViewRotations final : public ceres::EvaluationCallback {
 public:
  struct Rotation {
    Eigen::Matrix3d matrix, left_jacobian;  ///< as in rotation.h
  };

  /// `camera_from_board` must outlive this.
  explicit ViewRotations(const std::vector<std::array<double, 6>>& camera_from_board);
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;
  const Rotation& operator[](std::size_t view) const { return rotations_[view]; }

 private:
  const std::vector<std::array<double, 6>>& camera_from_board_;
  std::vector<Rotation> rotations_;
};

/// A BoardProblem for Ceres. Refers to the blocks of `parameters`, which must outlive it.
struct CeresProblem {
  explicit CeresProblem(const RgbdParameters& parameters);

  ViewRotations rotations;
  ceres::Problem problem;
};

std::unique_ptr<CeresProblem> make_problem(const BoardProblem& problem, RgbdParameters& parameters);

struct SolverLimits {
  int max_iterations = 500;
  double cost_tolerance = 1e-10, parameter_tolerance = 1e-10;  ///< relative
  int num_threads = 1;
};

/// Gaussian prior of a parameter block: (value - mean) / sigma. An empty mean is 0. An infinite
/// sigma gives a zero residual.
ceres::CostFunction* gaussian_prior(std::span<const double> mean, std::span<const double> sigma);

/// Minimises by Levenberg-Marquardt. Returns false if Ceres does not converge or the cost is not
/// finite.
bool minimize(ceres::Problem& problem, const SolverLimits& limits);

/// Indices of the views with BoardProblem::used, increasing.
std::vector<std::size_t> used_views(const BoardProblem& problem);

}  // namespace touchtrace
