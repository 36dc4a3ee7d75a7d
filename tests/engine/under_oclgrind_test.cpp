// What scripts/oclgrind_kernels runs under oclgrind: every kernel at its smallest shape, and two
// faults planted on purpose, which oclgrind must report.
#include <gtest/gtest.h>

#include "engine/ops/self_test.h"

namespace touchtrace {
namespace {

TEST(UnderOclgrind, EveryOperationAtItsSmallestShape) {
  Runtime runtime(choose_device(""));
  for (const auto& result : self_test(runtime))
    EXPECT_TRUE(result.holds()) << result.operation << ": " << result.fault << " "
                                << result.output_error << " eps, gradient "
                                << result.gradient_error;
}

/// Runs `body` over 16 work-items with a buffer `out` of 16 floats.
void run_planted(const std::string& body) {
  Runtime runtime(choose_device(""));
  const auto out = runtime.allocate_zeros<float>(16);
  cl::Program program(runtime.context(),
                      "__kernel void planted(__global float* out) {" + body + "}");
  program.build();
  cl::Kernel kernel(program, "planted");
  kernel.setArg(0, out.handle());
  runtime.launch(kernel, cl::NDRange(16), cl::NDRange(1));
  runtime.finish();
}

TEST(UnderOclgrind, DISABLED_PlantedOverrun) { run_planted("out[get_global_id(0) + 1] = 1.0f;"); }

TEST(UnderOclgrind, DISABLED_PlantedRace) {
  run_planted("out[get_global_id(0) / 2] += get_global_id(0);");
}

}  // namespace
}  // namespace touchtrace
