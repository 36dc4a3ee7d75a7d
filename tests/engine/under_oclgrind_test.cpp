// Run under oclgrind by scripts/oclgrind_kernels: every kernel at its smallest shape, and two
// deliberate faults that oclgrind must report.
#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "engine/check/operation_check.h"

namespace touchtrace {
namespace {

void check_small_cases(Runtime& runtime, const Operation& operation) {
  // The GPU variant has many work-items, which oclgrind runs one by one. Its first two cases, with
  // input in blocks and in planes, use all of its kernels.
  const auto cases = runtime.kernel_variant() == KernelVariant::gpu
                         ? std::min<std::size_t>(operation.small_cases, 2)
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
  for (const auto variant : {KernelVariant::cpu, KernelVariant::gpu}) {
    Runtime runtime(device, Accuracy::fast, variant);
    for (const auto& operation : operations())
      if (variant == KernelVariant::cpu || operation.has_gpu_variant)
        check_small_cases(runtime, operation);
  }
}

/// Runs a kernel with `body` over 16 work-items with a buffer `out` of 16 floats.
void run_faulty_kernel(const std::string& body) {
  Runtime runtime(choose_device(""));
  const auto out = runtime.allocate_zeros<float>(16);
  cl::Program program(runtime.context(),
                      "__kernel void faulty(__global float* out) {" + body + "}");
  program.build();
  cl::Kernel kernel(program, "faulty");
  kernel.setArg(0, out.handle());
  runtime.launch(kernel, cl::NDRange(16), cl::NDRange(1));
  runtime.finish();
}

TEST(UnderOclgrind, DISABLED_DeliberateOverrun) {
  run_faulty_kernel("out[get_global_id(0) + 1] = 1.0f;");
}

TEST(UnderOclgrind, DISABLED_DeliberateRace) {
  run_faulty_kernel("out[get_global_id(0) / 2] += get_global_id(0);");
}

}  // namespace
}  // namespace touchtrace
