// What scripts/oclgrind_kernels runs under oclgrind: every kernel at its smallest shape, and two
// faults planted on purpose, which oclgrind must report.
#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "engine/check/operation_check.h"

namespace touchtrace {
namespace {

void check_small_cases(Runtime& runtime, const Operation& operation) {
  // Lanes are many: two cases have every kernel of theirs, with input in blocks and in planes.
  const auto cases = runtime.body() == Body::lanes ? std::min<std::size_t>(operation.small_cases, 2)
                                                   : operation.small_cases;
  for (const auto& small : std::span(operation.cases).first(cases)) {
    SCOPED_TRACE(operation.name + ": " + small.shape);
    const auto inputs = draw_inputs(small, 1, gradient_kink_margin);
    EXPECT_LE(output_error(runtime, small, inputs), output_error_bound);
    if (!small.backward) continue;
    EXPECT_LE(gradient_error(runtime, small, inputs, 1), gradient_error_bound);
  }
}

TEST(UnderOclgrind, EveryOperationAtItsSmallestShapes) {
  const auto device = choose_device("");
  for (const auto body : {Body::vectors, Body::lanes}) {
    Runtime runtime(device, Accuracy::fast, body);
    for (const auto& operation : operations())
      if (body == Body::vectors || operation.has_lanes) check_small_cases(runtime, operation);
  }
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
