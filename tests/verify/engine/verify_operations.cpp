#include <fmt/core.h>

#include <algorithm>
#include <random>

#include "engine/check/operation_check.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

using Error = std::function<double(const OperationCase&)>;

/// Largest error over the shapes of an operation; NaN counts as largest.
double worst(const Operation& operation, const Error& error) {
  double largest = 0.0;
  for (const auto& operation_case : operation.cases)
    if (const double value = error(operation_case); !(value <= largest)) largest = value;
  return largest;
}

void verify_operation(Runtime& runtime, const Operation& operation, std::uint64_t seed,
                      const std::function<void(Figure)>& emit) {
  const auto& device = runtime.device();
  const auto output = [&](const OperationCase& c) {
    return output_error(runtime, c, draw_inputs(c, seed));
  };
  const auto gradient = [&](const OperationCase& c) {
    return c.backward ? gradient_error(runtime, c, draw_inputs(c, seed, gradient_kink_margin), seed)
                      : 0.0;
  };
  const auto name = fmt::format("{} on device {}", operation.name, device.number);
  emit(at_most(name + ", output", worst(operation, output), "eps", output_error_bound));
  if (operation.cases.front().backward)
    emit(
        at_most(name + ", gradient", worst(operation, gradient), "relative", gradient_error_bound));
}

/// Gain of Accuracy::exact in the longest inner products of the table.
void verify_exact(std::uint64_t seed, const std::function<void(Figure)>& emit) {
  const auto& dense = *std::ranges::find(operations(), "dense", &Operation::name);
  const auto& longest = *std::ranges::max_element(dense.cases, {}, &OperationCase::terms);
  const auto inputs = draw_inputs(longest, seed);
  const auto error = [&](Accuracy accuracy) {
    Runtime runtime(choose_device(""), accuracy);
    return output_error(runtime, longest, inputs);
  };
  const double fast = error(Accuracy::fast);
  const auto name = fmt::format("inner products of {} terms", longest.terms);
  emit(reported(name + ", fast", fast, "eps"));
  emit(at_most(name + ", exact against fast", error(Accuracy::exact) / fast, "times", 0.5));
}

}  // namespace

void verify_operations(const std::function<void(Figure)>& emit) {
  const std::uint64_t seed = std::random_device{}();
  emit(reported("seed of the inputs", static_cast<double>(seed), ""));
  for (const auto& device : list_devices()) {
    Runtime runtime({device, "verified"});
    for (const auto& operation : operations()) verify_operation(runtime, operation, seed, emit);
  }
  verify_exact(seed, emit);
}

}  // namespace touchtrace
