#include "calib/smooth/minimize.h"

#include <ceres/first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <utility>

#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

using Objective = std::function<double(const double*, double*)>;

class Function : public ceres::FirstOrderFunction {
 public:
  Function(Objective evaluate, std::size_t size) : evaluate_(std::move(evaluate)), size_(size) {}
  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    *cost = evaluate_(x, gradient);
    // Ceres aborts where a value is finite and its gradient is not
    for (std::size_t i = 0; gradient && i < size_; ++i)
      if (!std::isfinite(gradient[i])) gradient[i] = 0.0;
    return std::isfinite(*cost);
  }
  int NumParameters() const override { return static_cast<int>(size_); }

 private:
  Objective evaluate_;
  std::size_t size_;
};

}  // namespace

bool minimize(const Objective& evaluate, std::vector<double>& x, int max_iterations) {
  const ceres::GradientProblem problem(new Function(evaluate, x.size()));
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = max_iterations;
  ceres::GradientProblemSolver::Summary summary;
  auto best = x;
  ceres::Solve(options, problem, best.data(), &summary);
  if (!summary.IsSolutionUsable()) return false;
  x = best;
  return true;
}

Objective with_numeric_gradient(std::function<double(const double*)> function,
                                std::size_t num_parameters, double step, int num_threads) {
  return [=](const double* x, double* gradient) {
    if (!gradient) return function(x);
    std::vector<double> values(2 * num_parameters + 1);
    parallel_for(values.size(), num_threads, [&](std::size_t i) {
      std::vector<double> at(x, x + num_parameters);
      if (i > 0) at[(i - 1) / 2] += i % 2 == 1 ? step : -step;
      values[i] = function(at.data());
    });
    for (std::size_t i = 0; i < num_parameters; ++i)
      gradient[i] = (values[2 * i + 1] - values[2 * i + 2]) / (2.0 * step);
    return values[0];
  };
}

}  // namespace touchtrace
