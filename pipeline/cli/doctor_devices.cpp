#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/base/child_process.h"
#include "engine/base/error.h"
#include "pipeline/cli/doctor.h"

// Drivers crash and hang: only child processes of this program load them.
namespace touchtrace::cli {
namespace {

using nlohmann::json;

// A driver may have to compile all kernels.
constexpr double self_test_limit_s = 300.0;

const char* const other_device =
    "update its driver, or choose another device of `touchtrace devices` with --device";

std::vector<Finding> findings_from(const std::string& device, const json& operations) {
  std::vector<Finding> findings;
  double worst = 0.0;
  for (const auto& row : operations) {
    const std::string operation = row.at("operation"), fault = row.at("fault");
    if (!row.at("holds"))
      findings.push_back({Finding::State::broken,
                          fmt::format("{}: {} {}", device, operation,
                                      fault.empty() ? "computes wrong values" : "fails: " + fault),
                          other_device});
    else
      worst = std::max(worst, row.at("output_error_eps").get<double>());
  }
  if (findings.empty())
    findings.push_back(
        {Finding::State::good,
         fmt::format("{}: {} operations match their references (worst error {:.2g} eps)", device,
                     operations.size(), worst),
         ""});
  return findings;
}

std::vector<Finding> check_device(int number, const std::string& name) {
  const auto test =
      run_self({"self-test", "--json", "--device", std::to_string(number)}, {}, self_test_limit_s);
  const auto document = json::parse(test.output, nullptr, false);
  if (document.is_discarded())
    return {{Finding::State::broken, fmt::format("{}: its test {}", name, test.ending()),
             other_device}};
  return findings_from(name, document.at("operations"));
}

}  // namespace

std::vector<Finding> check_devices() {
  const auto listing = run_self({"devices", "--json"}, {}, self_test_limit_s);
  if (listing.exit_code == static_cast<int>(ExitCode::no_device))
    return {{Finding::State::broken, "no OpenCL device",
             "install PoCL, which runs on any CPU: sudo apt-get install pocl-opencl-icd"}};
  const auto document = json::parse(listing.output, nullptr, false);
  if (document.is_discarded())
    return {{Finding::State::broken, fmt::format("listing the OpenCL devices {}", listing.ending()),
             "a driver is faulty: remove its .icd file from /etc/OpenCL/vendors"}};
  std::vector<Finding> findings;
  for (const auto& device : document.at("devices"))
    std::ranges::move(check_device(device.at("number"), device.at("name")),
                      std::back_inserter(findings));
  return findings;
}

}  // namespace touchtrace::cli
