#pragma once

#include <ceres/problem.h>

#include <memory>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// The problem over the blocks of `parameters`, which must outlive it.
std::unique_ptr<ceres::Problem> make_problem(const BoardProblem& problem,
                                             RgbdParameters& parameters);

std::vector<std::size_t> used_views(const BoardProblem& problem);

}  // namespace touchtrace
