#pragma once

#include <string>
#include <vector>

#include "tests/verify/calib/simulated_boards.h"

namespace touchtrace {

/// Statistics over calibrations of the same scene with independent noise.
struct MonteCarlo {
  int runs = 0;
  double color_nees = 0.0;  ///< mean of e' C^-1 e / n over the n parameters of the colour camera
  double nees = 0.0;        ///< the same over all parameters
  std::vector<std::string> names;
  std::vector<double> rmse_ratio;  ///< RMSE over the Cramer-Rao bound, for each name
  int num_free_deformations = 0;   ///< runs that estimated per-corner deformation
  double cpu_s = 0.0;              ///< CPU seconds of one calibration, mean
};

/// Run i draws noise, tangential distortion, warp, deformation and the factory's error from the
/// random stream i. The result, cpu_s apart, does not depend on the number of threads. Throws if a
/// coefficient of the lens is unobservable in a run.
MonteCarlo monte_carlo(const SimulatedBoards& boards, int runs);

}  // namespace touchtrace
