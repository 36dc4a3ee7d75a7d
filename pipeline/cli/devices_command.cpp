#include <fmt/core.h>

#include "engine/cl/device.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct DevicesOptions {};

void describe(OptionSet&, DevicesOptions&) {}

nlohmann::json to_json(const DeviceInfo& info) {
  return {{"number", info.number},
          {"name", info.name},
          {"platform", info.platform},
          {"driver", info.driver},
          {"type", info.type},
          {"compute_units", info.compute_units},
          {"memory_bytes", info.memory_bytes},
          {"has_doubles", info.has_doubles}};
}

ExitCode run(const DevicesOptions&, const Invocation& invocation) {
  const auto chosen = choose_device(invocation.device);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& info : list_devices()) {
    rows.push_back(to_json(info));
    if (!invocation.json)
      fmt::print("{} {}: {} ({}, {} units, {:.1f} GiB, {})\n",
                 info.number == chosen.info.number ? "*" : " ", info.number, info.name, info.type,
                 info.compute_units, static_cast<double>(info.memory_bytes) / (1u << 30),
                 info.driver);
  }
  if (invocation.json)
    fmt::print("{}\n",
               nlohmann::json{
                   {"devices", rows}, {"default", chosen.info.number}, {"reason", chosen.reason}}
                   .dump(2));
  else
    fmt::print("* used: {}\n", chosen.reason);
  return ExitCode::done;
}

}  // namespace

Command devices_command() {
  return make_command<DevicesOptions>("devices", "list OpenCL devices and the one that is used",
                                      {"touchtrace devices", "touchtrace devices --json"}, run,
                                      {.device = true});
}

}  // namespace touchtrace::cli
