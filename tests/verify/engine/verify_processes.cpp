#include "tests/verify/engine/verify_processes.h"

#include <fmt/core.h>

#include "engine/base/child_process.h"
#include "engine/base/error.h"
#include "engine/base/scratch_folder.h"

namespace touchtrace {
namespace {

using Environment = std::map<std::string, std::string>;

constexpr double max_silence_s = 60.0;

ChildResult verify(const std::string& area, const Environment& environment) {
  auto result = run_self({area, "--json"}, environment, max_silence_s);
  if (!result.succeeded())
    throw failure(fmt::format("`touchtrace-verify {}` {}", area, result.ending()),
                  "run it alone to see why");
  return result;
}

/// Value of the only row of an area.
double value_of(const ChildResult& result) {
  return nlohmann::json::parse(result.output).at("figures").at(0).at("value");
}

void verify_start(const std::string& name, const Environment& environment, double goal_s,
                  const std::function<void(Figure)>& emit) {
  const auto result = verify("first-step", environment);
  emit(at_most("process start to first training step and end, " + name, result.wall_seconds, "s",
               goal_s));
  emit(reported("process start to first training step and end, " + name + ", CPU time",
                result.cpu_seconds, "s"));
}

}  // namespace

void verify_processes(const std::function<void(Figure)>& emit) {
  const ScratchFolder cache;
  const Environment environment{{"POCL_CACHE_DIR", cache.path().string()}};
  verify_start("cold cache", environment, 5.0, emit);
  verify_start("warm cache", environment, 0.5, emit);
  const auto weights = [](const char* threads) {
    return value_of(verify("weights", {{"POCL_MAX_PTHREAD_COUNT", threads}}));
  };
  emit(at_most("weights after 200 updates, 1 thread against 2, hashes that differ",
               weights("1") == weights("2") ? 0.0 : 1.0, "", 0.0));
}

}  // namespace touchtrace
