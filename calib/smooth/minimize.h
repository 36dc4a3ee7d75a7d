#pragma once

#include <functional>
#include <vector>

namespace touchtrace {

/// Minimises a function by L-BFGS (Ceres), from `x` on. `evaluate` returns the value at its first
/// argument and, where the second one is not null, sets the gradient. The value is
/// not finite where the function is not defined. A derivative that is not finite counts as 0.
/// Returns whether the search ended normally.
bool minimize(const std::function<double(const double*, double*)>& evaluate, std::vector<double>& x,
              int max_iterations);

/// A function with its gradient by central differences of half width `step`, evaluated on
/// `num_threads` threads (0: one per core).
std::function<double(const double*, double*)> with_numeric_gradient(
    std::function<double(const double*)> function, std::size_t num_parameters, double step,
    int num_threads);

}  // namespace touchtrace
