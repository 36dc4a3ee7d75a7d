#pragma once

#include <string>
#include <vector>

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Candidate lens and the estimated entries of RgbdParameters::color.
struct LensChoice {
  Lens named, lens;  ///< `lens` is fitted; they differ for "none": radtan4 without k1 and k2
  std::vector<int> free_color;
};

/// Throws usage_error for an unknown name.
LensChoice lens_choice(const std::string& name);
/// Candidates in the order of `names`; empty: all lenses, simple ones first.
std::vector<LensChoice> lens_choices(const std::vector<std::string>& names);

struct UnobservableCoefficient {
  int index;  ///< in RgbdParameters::color
  std::string name, why;
};

/// Returns the coefficients to fix at 0. While one standard deviation of any coefficient moves the
/// outermost corner by its whole distance from the centre or more, the last free coefficient is
/// unobservable. Coefficients with a prior are always observable.
std::vector<UnobservableCoefficient> find_unobservable_coefficients(
    const BoardProblem& problem, const RgbdParameters& parameters);

}  // namespace touchtrace
