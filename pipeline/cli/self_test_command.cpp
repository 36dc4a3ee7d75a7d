#include <fmt/core.h>

#include "engine/check/self_test.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct SelfTestOptions {
  bool trust_pocl = false;
};

void describe(OptionSet& set, SelfTestOptions& o) {
  set.flag("trust-pocl", o.trust_pocl, "do not test a device of PoCL");
}

nlohmann::json to_json(const OperationResult& result) {
  return {{"operation", result.operation},
          {"holds", result.passes()},
          {"output_error_eps", result.output_error},
          {"gradient_error", result.gradient_error},
          {"fault", result.fault}};
}

void print_line(const DeviceInfo& device, const OperationResult& result) {
  if (result.passes())
    fmt::print("{}: {:.2g} eps, gradient {:.2g}\n", result.operation, result.output_error,
               result.gradient_error);
  else
    fmt::print("{}: {} {}\n", device.name, result.operation,
               result.fault.empty() ? "computes wrong values" : "fails: " + result.fault);
  std::fflush(stdout);  // a reader of a pipe sees progress
}

/// Tests operations until one fails.
std::vector<OperationResult> test(const ChosenDevice& chosen, bool print) {
  std::vector<OperationResult> results;
  const auto add = [&](OperationResult result) {
    if (print) print_line(chosen.info, result);
    results.push_back(std::move(result));
    return results.back().passes();
  };
  try {
    Runtime runtime(chosen);
    for (const auto& operation : operations())
      if (!add(self_test(runtime, operation))) break;
  } catch (const Error& error) {
    add({.operation = "starting the device", .fault = error.what()});
  }
  return results;
}

ExitCode run(const SelfTestOptions& options, const Invocation& invocation) {
  const auto chosen = choose_device(invocation.device);
  if (options.trust_pocl && chosen.info.is_pocl) return ExitCode::done;
  const auto results = test(chosen, !invocation.json);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& result : results) rows.push_back(to_json(result));
  if (invocation.json)
    fmt::print("{}\n", nlohmann::json{{"device", chosen.info.name}, {"operations", rows}}.dump(2));
  return results.back().passes() ? ExitCode::done : ExitCode::data;
}

}  // namespace

Command self_test_command() {
  return make_command<SelfTestOptions>(
      "self-test", "compare every OpenCL operation with a double-precision reference",
      {"touchtrace self-test", "touchtrace self-test --device 1 --json"}, run, {.device = true});
}

}  // namespace touchtrace::cli
