#pragma once

#include <string>
#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// A lens that calibrate may choose, and which of RgbdParameters::color are free in it.
struct LensChoice {
  Lens named, lens;  ///< "none" is fitted as radtan4 without k1 and k2
  std::vector<int> free_color;
};

/// Throws usage_error if there is no such lens.
LensChoice lens_choice(const std::string& name);
/// From simple to rich; all if `names` is empty.
std::vector<LensChoice> lens_choices(const std::vector<std::string>& names);

struct Untold {
  int index;  ///< in RgbdParameters::color
  std::string name, why;
};

/// While the data leave a coefficient so open that its deviation alone would move the outermost
/// corner by its whole distance from the centre, the last free one is untold. Coefficients with a
/// prior are told by that.
std::vector<Untold> untold_coefficients(const BoardProblem& problem,
                                        const RgbdParameters& parameters);

}  // namespace touchtrace
