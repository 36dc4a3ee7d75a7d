// The activations of kernels/dynamics.clh, value by value, as far as 1e4 from zero.
#include "engine/ops/activation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/cl/kernel_sources.h"
#include "engine/cl/launch.h"

namespace touchtrace {
namespace {

constexpr double eps = std::numeric_limits<float>::epsilon(),
                 smallest_normal = std::numeric_limits<float>::min();

/// Both signs of 0 and of sizes from 1e-8 to 1e4; a multiple of 16.
std::vector<float> far_sums() {
  std::vector<float> sums{0.0f, -0.0f};
  while (sums.size() < 4096) {
    const float size = std::pow(10.0f, -8.0f + 12.0f * float(sums.size()) / 4094.0f);
    sums.insert(sums.end(), {size, -size});
  }
  return sums;
}

struct Computed {
  std::vector<float> value, slope;
};

Computed on_device(Runtime& runtime, Activation activation, const std::vector<float>& sums) {
  const std::string body = R"(
__kernel void activate(__global const real* sums, __global real* value, __global real* slope) {
  const size_t i = get_global_id(0);
  const real16 x = vload16(i, sums), y = ACTIVATE(x);
  vstore16(y, i, value);
  vstore16(ACTIVATE_BACKWARD((real16)(1), SLOPE_FROM_SUM ? x : y), i, slope);
})";
  std::string source;
  for (const char* file : {"common.clh", "dynamics.clh"}) source += kernel_sources().at(file);
  cl::Program program(runtime.context(), source + body);
  const auto name = kernel_name_of(activation);
  program.build(
      ("-cl-std=CL1.2 -cl-denorms-are-zero -D HIDDEN=64 -D STATE=1 -D ACTIVATION=" + name).c_str());
  const auto in = runtime.upload<float>(sums), value = runtime.allocate<float>(sums.size()),
             slope = runtime.allocate<float>(sums.size());
  cl::Kernel kernel(program, "activate");
  kernel.setArg(0, in.handle());
  kernel.setArg(1, value.handle());
  kernel.setArg(2, slope.handle());
  runtime.launch(kernel, range(int(sums.size()) / 16));
  return {runtime.download(value), runtime.download(slope)};
}

class EveryActivation : public ::testing::TestWithParam<Activation> {};

TEST_P(EveryActivation, IsAccurateAndFiniteFarOut) {
  Runtime runtime(choose_device(""));
  const auto sums = far_sums();
  const auto computed = on_device(runtime, GetParam(), sums);
  const std::vector<double> x(sums.begin(), sums.end());
  const auto value = activation_reference(GetParam(), x);
  const auto slope =
      activation_backward_reference(GetParam(), x, std::vector<double>(x.size(), 1.0));
  for (std::size_t i = 0; i < x.size(); ++i) {
    // OpenCL allows exp 3 units in the last place and tanh 5; a slope is computed from values
    // near 1. exp(-|x|), of which SiLU is |x| times as large, counts as zero where float flushes
    // it.
    EXPECT_LE(std::abs(computed.value[i] - value[i]),
              5 * eps * std::abs(value[i]) + (1 + std::abs(x[i])) * smallest_normal)
        << x[i];
    EXPECT_LE(std::abs(computed.slope[i] - slope[i]), 10 * eps) << x[i];
  }
}

TEST_P(EveryActivation, IsKnownByItsName) {
  EXPECT_EQ(activation_of(name_of(GetParam())), GetParam());
  EXPECT_THROW(activation_of("swish"), Error);
}

INSTANTIATE_TEST_SUITE_P(Activations, EveryActivation,
                         ::testing::Values(Activation::relu, Activation::silu, Activation::tanh),
                         [](const auto& row) { return std::string(name_of(row.param)); });

}  // namespace
}  // namespace touchtrace
