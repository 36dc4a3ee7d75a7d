#include <algorithm>
#include <cstdlib>

#include "engine/base/progress.h"
#include "tests/fuzz/fuzz_targets.h"

/// Entry point of libFuzzer; TOUCHTRACE_FUZZ_TARGET names the target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace touchtrace;
  static const auto target = [] {
    Progress::silence();
    return std::ranges::find(fuzz_targets(), std::string(std::getenv("TOUCHTRACE_FUZZ_TARGET")),
                             &FuzzTarget::name);
  }();
  run_fuzz_target(*target, {data, size});
  return 0;
}
