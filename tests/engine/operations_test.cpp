// Every operation on every OpenCL device of this machine.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <random>

#include "engine/check/operation_check.h"
#include "engine/ops/conv2d.h"

namespace touchtrace {
namespace {

/// Seed of this run, printed; TOUCHTRACE_TEST_SEED sets it.
std::uint64_t test_seed() {
  static const std::uint64_t seed = [] {
    const char* given = std::getenv("TOUCHTRACE_TEST_SEED");
    const std::uint64_t value = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::printf("TOUCHTRACE_TEST_SEED=%llu\n", static_cast<unsigned long long>(value));
    return value;
  }();
  return seed;
}

/// Devices of this machine. PoCL skips integer divisions by zero in kernels; here they end the
/// program, since their results are undefined.
std::vector<DeviceInfo> devices_that_trap() {
  auto devices = list_devices();
  std::signal(SIGFPE, SIG_DFL);
  return devices;
}

/// Kernel variants of an operation that the device supports.
std::vector<KernelVariant> supported_variants(const Operation& operation,
                                              const DeviceInfo& device) {
  if (!operation.has_gpu_variant || !supports_gpu_variant(device)) return {KernelVariant::cpu};
  return {KernelVariant::cpu, KernelVariant::gpu};
}

using OnCase = std::function<void(Runtime&, const OperationCase&)>;

class EveryOperation : public ::testing::TestWithParam<Operation> {
 protected:
  void on_every_device(const OnCase& check) {
    const auto devices = devices_that_trap();
    ASSERT_FALSE(devices.empty()) << "no OpenCL device: install pocl-opencl-icd";
    for (const auto& device : devices)
      for (const auto body : supported_variants(GetParam(), device)) {
        Runtime runtime({device, "test"}, Accuracy::fast, body);
        for (const auto& operation : GetParam().cases) {
          SCOPED_TRACE(device.name + (body == KernelVariant::gpu ? ", lanes: " : ": ") +
                       operation.shape);
          check(runtime, operation);
        }
      }
  }
};

Arrays filled(const OperationCase& operation, double value) {
  Arrays inputs;
  for (auto size : operation.input_sizes) inputs.emplace_back(size, value);
  if (operation.prepare) operation.prepare(inputs);
  return inputs;
}

TEST_P(EveryOperation, AgreesWithTheReference) {
  on_every_device([](Runtime& runtime, const OperationCase& operation) {
    EXPECT_LE(output_error(runtime, operation, draw_inputs(operation, test_seed())),
              output_error_bound);
  });
}

TEST_P(EveryOperation, AgreesWithTheReferenceInExactMode) {
  const auto& operation = GetParam().cases.front();
  const auto inputs = draw_inputs(operation, test_seed(), gradient_kink_margin);
  for (const auto& device : devices_that_trap())
    for (const auto body : supported_variants(GetParam(), device)) {
      Runtime runtime({device, "test"}, Accuracy::exact, body);
      EXPECT_LE(output_error(runtime, operation, inputs), output_error_bound);
      if (!operation.backward) continue;
      EXPECT_LE(gradient_error(runtime, operation, inputs, test_seed()), gradient_error_bound);
    }
}

TEST_P(EveryOperation, GradientAgreesWithTheReference) {
  on_every_device([](Runtime& runtime, const OperationCase& operation) {
    if (!operation.backward) return;
    const auto inputs = draw_inputs(operation, test_seed(), gradient_kink_margin);
    EXPECT_LE(gradient_error(runtime, operation, inputs, test_seed()), gradient_error_bound);
  });
}

TEST_P(EveryOperation, ReferenceGradientAgreesWithCentralDifferences) {
  for (const auto& operation : GetParam().cases) {
    if (!operation.reference_backward) continue;
    SCOPED_TRACE(operation.shape);
    const auto inputs = draw_inputs(operation, test_seed(), gradient_kink_margin);
    EXPECT_LE(reference_gradient_error(operation, inputs, test_seed()), reference_gradient_bound);
  }
}

TEST_P(EveryOperation, AcceptsEqualInputs) {
  on_every_device([](Runtime& runtime, const OperationCase& operation) {
    const double sums_of_this_round = static_cast<float>(1023.0 / 7);
    for (const double value : {0.0, 1023.0, sums_of_this_round})
      EXPECT_LE(output_error(runtime, operation, filled(operation, value)), output_error_bound);
  });
}

TEST_P(EveryOperation, AcceptsSubnormalInputs) {
  on_every_device([](Runtime& runtime, const OperationCase& operation) {
    // Each summand may lose one smallest normal number, and its factors are about 1.
    const double smallest = std::numeric_limits<float>::min();
    auto inputs = draw_inputs(operation, test_seed());
    for (auto& value : inputs[0]) value = static_cast<float>(value * smallest / 100);
    if (operation.prepare) operation.prepare(inputs);
    EXPECT_LE(output_error(runtime, operation, inputs, 10 * operation.terms * smallest),
              output_error_bound);
  });
}

INSTANTIATE_TEST_SUITE_P(Table, EveryOperation, ::testing::ValuesIn(operations()),
                         [](const auto& row) { return row.param.name; });

// The bound of the changed parameters must be smaller than an update.
TEST(AdamCases, RejectAnUpdateThatChangesNothing) {
  for (const auto& operation : operations()) {
    if (operation.name != "adam") continue;
    for (const auto& c : operation.cases) {
      const auto change = c.reference(draw_inputs(c, 1)).front();
      const std::vector<double> nothing(change.size(), 0.0);
      EXPECT_GT(array_error(nothing, change, c.terms), 100 * output_error_bound) << c.shape;
    }
  }
}

// The operation `winograd` would also pass if the direct method replaced it.
TEST(Conv2d, UsesWinogradWhereLocalMemoryHoldsAnImage) {
  Runtime runtime(choose_device(""), Accuracy::fast, KernelVariant::cpu);
  const Conv2dShape shape{2, 32, 16, 16, 64, false};
  const auto weights = shape.weight_size();
  const auto conv = make_conv2d(
      runtime, shape, {runtime.allocate<float>(weights + 64), {}, 0, static_cast<int>(weights)},
      Conv2dMethod::winograd);
  const Conv2dMicroBatch batch{2,
                               runtime.allocate<float>(shape.in_size()),
                               runtime.allocate<float>(shape.out_size()),
                               {},
                               {}};
  const auto memory = runtime.device().handle.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  EXPECT_EQ(conv->forward(batch).front().name(),
            memory >= (256u << 10) ? "winograd_forward" : "conv2d_forward");
}

}  // namespace

void PrintTo(const Operation& operation, std::ostream* out) { *out << operation.name; }

}  // namespace touchtrace
