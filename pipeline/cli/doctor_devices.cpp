#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/ops/self_test.h"
#include "pipeline/cli/doctor.h"

namespace touchtrace::cli {
namespace {

Finding describe_fault(const DeviceInfo& device, const OperationResult& result) {
  const auto what = result.fault.empty()
                        ? fmt::format("is wrong by {:.3g} eps, its gradient by {:.3g}",
                                      result.output_error, result.gradient_error)
                        : "fails: " + result.fault;
  return {Finding::State::broken, fmt::format("{}: {} {}", device.name, result.operation, what),
          "update its driver, or pass --device with another number of `touchtrace devices`"};
}

std::vector<Finding> check_kernels(const DeviceInfo& device) {
  Runtime runtime({device, "looked at by doctor"});
  const auto results = self_test(runtime);
  std::vector<Finding> findings;
  double worst = 0.0;
  for (const auto& result : results) {
    if (!result.holds()) findings.push_back(describe_fault(device, result));
    worst = std::max(worst, result.output_error);
  }
  if (findings.empty())
    findings.push_back(
        {Finding::State::good,
         fmt::format("{}: {} operations agree with their references (worst {:.2g} eps)",
                     device.name, results.size(), worst),
         ""});
  return findings;
}

std::vector<Finding> check_device(const DeviceInfo& device) {
  try {
    return check_kernels(device);
  } catch (const Error& error) {
    return {{Finding::State::broken, error.what(), error.remedy()}};
  }
}

}  // namespace

std::vector<Finding> check_devices() {
  const auto devices = list_devices();
  if (devices.empty())
    return {{Finding::State::broken, "no OpenCL device",
             "install PoCL, which runs on any processor: apt-get install pocl-opencl-icd"}};
  std::vector<Finding> findings;
  for (const auto& device : devices)
    std::ranges::move(check_device(device), std::back_inserter(findings));
  return findings;
}

}  // namespace touchtrace::cli
