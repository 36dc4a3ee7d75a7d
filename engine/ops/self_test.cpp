#include "engine/ops/self_test.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/ops/operation_check.h"

namespace touchtrace {
namespace {

constexpr std::uint64_t seed = 1;

OperationResult test_operation(Runtime& runtime, const Operation& operation) {
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

/// The first thing that is wrong with a device; empty if nothing is.
std::string fault_of(const ChosenDevice& device) {
  try {
    Runtime runtime(device);
    for (const auto& result : self_test(runtime))
      if (!result.holds())
        return fmt::format(
            "{} {}", result.operation,
            result.fault.empty() ? "computes wrong values" : "fails: " + result.fault);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

bool OperationResult::holds() const {
  return fault.empty() && output_error <= output_error_bound &&
         gradient_error <= gradient_error_bound;
}

std::vector<OperationResult> self_test(Runtime& runtime) {
  std::vector<OperationResult> results;
  for (const auto& operation : operations()) results.push_back(test_operation(runtime, operation));
  return results;
}

ChosenDevice pocl_instead_of(const ChosenDevice& refused, const std::string& fault) {
  const auto reason = fmt::format("{} is refused: {}", refused.info.name, fault);
  const auto devices = list_devices();
  const auto pocl = std::ranges::find(devices, true, &DeviceInfo::is_pocl);
  if (pocl == devices.end())
    throw device_error(
        reason, "install PoCL, which runs on any processor: apt-get install pocl-opencl-icd");
  fmt::print(stderr, "warning: {}; {} computes instead\n", reason, pocl->name);
  return {*pocl, reason};
}

ChosenDevice usable_device(const std::string& wish) {
  const auto chosen = choose_device(wish);
  if (chosen.info.is_pocl) return chosen;
  const auto fault = fault_of(chosen);
  return fault.empty() ? chosen : pocl_instead_of(chosen, fault);
}

}  // namespace touchtrace
