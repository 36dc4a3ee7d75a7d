#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// A simulated quantity with a closed-form solution.
struct ClosedForm {
  std::string name, unit;
  double step_s;     ///< for `max_error`; the largest step of the convergence
  double max_error;  ///< required at that step
  double min_order;  ///< required order of convergence; 0: exact except for rounding
  std::function<double(double step_s)> error;
};
const std::vector<ClosedForm>& closed_forms();

/// Error over step [s], from `step_s` to an eighth of it by halving.
Picture::Curve convergence(const ClosedForm& form);
/// Slope of log error over log step, by least squares.
double order_of_convergence(const Picture::Curve& convergence);

}  // namespace touchtrace::scene
