#include "engine/check/self_test.h"

#include "engine/check/operation_check.h"

namespace touchtrace {
namespace {

constexpr std::uint64_t seed = 1;

}  // namespace

bool OperationResult::passes() const {
  return fault.empty() && output_error <= output_error_bound &&
         gradient_error <= gradient_error_bound;
}

OperationResult self_test(Runtime& runtime, const Operation& operation) {
  OperationResult result;
  result.operation = operation.name;
  try {
    const auto& smallest = operation.cases.front();
    const auto inputs = draw_inputs(smallest, seed, gradient_kink_margin);
    result.output_error = output_error(runtime, smallest, inputs);
    if (smallest.backward) result.gradient_error = gradient_error(runtime, smallest, inputs, seed);
  } catch (const std::exception& error) {
    result.fault = error.what();
  }
  return result;
}

}  // namespace touchtrace
