#include "calib/rgbd/cross_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/rgbd/ceres_problem.h"
#include "calib/rgbd/corner_error.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_folds = 10;

/// Sum of squared residuals [px^2] of the held-out views `fold`; NaN if not converged.
double held_out_squares(BoardProblem problem, RgbdParameters p, const std::vector<bool>& fold) {
  const auto all = problem.used;
  for (std::size_t view = 0; view < all.size(); ++view)
    problem.used[view] = all[view] && !fold[view];
  if (!solve(problem, p)) return std::numeric_limits<double>::quiet_NaN();
  problem.used = fold;
  problem.estimated = Estimated::board_poses;
  if (!solve(problem, p)) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0.0;
  for (std::size_t view = 0; view < fold.size(); ++view)
    if (fold[view])
      for (const auto& residual : corner_residuals(problem.observations, view, p))
        squares += residual.squaredNorm();
  return squares;
}

}  // namespace

HeldOut cross_validate(const BoardProblem& joint, const RgbdParameters& solution) {
  BoardProblem problem = joint;
  problem.samples.clear();
  const auto views = used_views(problem);
  const std::size_t folds = std::min(max_folds, views.size());
  double squares = 0.0;
  std::size_t corners = 0;
  for (std::size_t first = 0; first < folds; ++first) {
    std::vector<bool> fold(problem.used.size(), false);
    for (std::size_t i = first; i < views.size(); i += folds) {
      fold[views[i]] = true;
      corners += problem.observations.views[views[i]].corners_px.size();
    }
    squares += held_out_squares(problem, solution, fold);
  }
  return {rms_of_used_views(problem.observations, problem.used, solution),
          std::sqrt(squares / static_cast<double>(corners)), static_cast<int>(folds)};
}

nlohmann::json held_out_json(const HeldOut& held_out) {
  return {{"folds", held_out.folds},
          {"training_rms_px", held_out.training_rms_px},
          {"held_out_rms_px", held_out.held_out_rms_px}};
}

}  // namespace touchtrace
