#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// Something physics can do that a formula tells, too.
struct ClosedForm {
  std::string name, unit;
  double step_s;   ///< at which the error is shown, and the coarsest for the order
  double largest;  ///< error promised at that step
  double order;    ///< of convergence promised; 0: exact but for rounding
  std::function<double(double step_s)> error;
};
const std::vector<ClosedForm>& closed_forms();

/// Error over step [s], from `step_s` to an eighth of it by halves.
Picture::Curve convergence(const ClosedForm& form);
/// Slope of log error over log step, by least squares.
double order_of_convergence(const Picture::Curve& convergence);

}  // namespace touchtrace::scene
