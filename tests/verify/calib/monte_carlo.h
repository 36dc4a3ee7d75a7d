#pragma once

#include <string>
#include <vector>

#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {

/// Many calibrations of one scene under new noise, against the truth.
struct MonteCarlo {
  int runs = 0;
  double color_nees = 0.0;  ///< mean of e' C^-1 e / n over the n parameters of the colour camera
  double nees = 0.0;        ///< the same over all parameters
  std::vector<std::string> names;
  std::vector<double> rmse_ratio;  ///< RMSE over the Cramer-Rao bound, for each name
  int free_prints = 0;             ///< runs that found the board's corners to be off
  double solve_seconds = 0.0;      ///< processor time of one calibration, mean
};

/// Run i draws noise, tangential distortion, warp, print and the factory's error from the stream
/// `i`; the result does not depend on the number of threads.
MonteCarlo monte_carlo(const SimulatedBoards& boards, int runs);

}  // namespace touchtrace
