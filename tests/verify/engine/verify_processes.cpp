#include <fmt/core.h>

#include "engine/base/child_process.h"
#include "engine/base/error.h"
#include "engine/base/scratch_folder.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

constexpr double max_silence_s = 60.0;

void verify_start(const std::string& name, const ScratchFolder& cache, double goal_s,
                  const std::function<void(Figure)>& emit) {
  const auto result = run_self({"first-step", "--json"},
                               {{"POCL_CACHE_DIR", cache.path().string()}}, max_silence_s);
  if (!result.succeeded())
    throw failure("`touchtrace-verify first-step` " + result.ending(), "run it alone to see why");
  emit(at_most("process start to first training step and end, " + name, result.wall_seconds, "s",
               goal_s));
  emit(reported("process start to first training step and end, " + name + ", CPU time",
                result.cpu_seconds, "s"));
}

}  // namespace

void verify_processes(const std::function<void(Figure)>& emit) {
  const ScratchFolder cache;
  verify_start("cold cache", cache, 5.0, emit);
  verify_start("warm cache", cache, 0.5, emit);
}

}  // namespace touchtrace
