#include <fmt/core.h>

#include <algorithm>

#include "pipeline/cli/commands.h"
#include "pipeline/cli/doctor.h"

namespace touchtrace::cli {
namespace {

struct DoctorOptions {};

void describe(OptionSet&, DoctorOptions&) {}

const char* name_of(Finding::State state) {
  switch (state) {
    case Finding::State::good:
      return "good";
    case Finding::State::advice:
      return "advice";
    case Finding::State::broken:
      return "broken";
  }
  return "";
}

void print(const Finding& finding) {
  fmt::print("{:<7} {}\n", name_of(finding.state), finding.what);
  if (!finding.hint.empty()) fmt::print("        hint: {}\n", finding.hint);
}

nlohmann::json to_json(const std::vector<Finding>& findings) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& finding : findings)
    rows.push_back(
        {{"state", name_of(finding.state)}, {"what", finding.what}, {"fix", finding.hint}});
  return {{"findings", rows}};
}

ExitCode run(const DoctorOptions&, const Invocation& invocation) {
  std::vector<Finding> findings;
  for (const auto& check : {check_devices, check_packages, check_disk, check_usb})
    for (auto& finding : check()) {
      if (!invocation.json) print(finding);
      findings.push_back(std::move(finding));
    }
  if (invocation.json) fmt::print("{}\n", to_json(findings).dump(2));
  const bool broken = std::ranges::any_of(
      findings, [](const Finding& finding) { return finding.state == Finding::State::broken; });
  return broken ? ExitCode::failed : ExitCode::done;
}

}  // namespace

Command doctor_command() {
  return make_command<DoctorOptions>("doctor",
                                     "check OpenCL devices and kernels, packages, disk and USB",
                                     {"touchtrace doctor", "touchtrace doctor --json"}, run);
}

}  // namespace touchtrace::cli
