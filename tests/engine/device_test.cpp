#include "engine/cl/device.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "engine/base/error.h"
#include "engine/check/operation_check.h"
#include "engine/check/self_test.h"
#include "engine/model/model.h"
#include "engine/ops/sum.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

TEST(Device, IsSelectedByNumberTypeOrPartOfItsName) {
  const auto devices = list_devices();
  ASSERT_FALSE(devices.empty());
  const auto& last = devices.back();
  EXPECT_EQ(choose_device(std::to_string(last.number)).info.name, last.name);
  EXPECT_EQ(choose_device(last.type).info.type, last.type);
  EXPECT_EQ(choose_device(last.name.substr(1, 6)).info.name, last.name);
}

TEST(Device, ANumberIsNotAPartOfAName) {
  DeviceInfo first{}, second{};
  first.name = "H100", first.type = "gpu";
  second.name = "cpu of the gpu's host", second.type = "cpu", second.number = 1;
  const std::vector devices{first, second};
  EXPECT_EQ(find_device(devices, "0"), &devices[0]);
  EXPECT_EQ(find_device(devices, "1"), &devices[1]);
  EXPECT_EQ(find_device(devices, "100"), nullptr);
  EXPECT_EQ(find_device(devices, "GPU"), &devices[0]);
  EXPECT_EQ(find_device(devices, "h1"), &devices[0]);
  EXPECT_EQ(find_device(devices, "GPU's"), &devices[1]);
}

TEST(Device, UnknownSelectorIsAnErrorThatListsTheDevices) {
  testing::expect_error([] { choose_device("abacus"); }, list_devices().front().name,
                        ExitCode::no_device);
}

TEST(SelfTest, FailsOnErrorsNanAndFaults) {
  OperationResult result;
  EXPECT_TRUE(result.passes());
  result.output_error = 1.01 * output_error_bound;
  EXPECT_FALSE(result.passes());
  result.output_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(result.passes());
  result.output_error = 0.0, result.fault = "crashed";
  EXPECT_FALSE(result.passes());
}

/// Operation y = x with an error of `error` in one value.
OperationCase identity_off_by(double error) {
  OperationCase c;
  c.shape = "identity";
  c.input_sizes = {5};
  c.terms = 1;
  c.reference = [](const Arrays& in) { return in; };
  c.forward = [error](Runtime&, Arrays in) {
    in[0][3] += error;
    return in;
  };
  return c;
}

TEST(OperationCheck, DetectsOneWrongValue) {
  Runtime runtime(choose_device(""));
  const auto inputs = draw_inputs(identity_off_by(0), 1);
  EXPECT_EQ(output_error(runtime, identity_off_by(0), inputs), 0.0);
  EXPECT_GT(output_error(runtime, identity_off_by(1e-5), inputs), output_error_bound);
  EXPECT_TRUE(std::isinf(output_error(runtime, identity_off_by(NAN), inputs)));
}

TEST(Runtime, SideQueueRunsAfterForkAndBeforeJoin) {
  constexpr std::size_t size = 1 << 16;
  Runtime runtime(choose_device(""));
  const auto values = runtime.allocate<float>(size), total = runtime.allocate<float>(1);
  const auto adding = sum(runtime, values, total);
  for (int round = 1; round <= 20; ++round) {
    runtime.fill(values, static_cast<float>(round));
    runtime.fork();
    runtime.on_side_queue([&] { adding.enqueue(runtime); });
    runtime.join();
    EXPECT_EQ(runtime.download(total)[0], static_cast<float>(round) * size);
  }
}

TEST(Runtime, OutOfMemoryErrorNamesSizeAndOptions) {
  Runtime runtime(choose_device(""));
  for (const auto* part : {"268435456 MiB", "--sequences"})
    testing::expect_error([&] { runtime.allocate<float>(std::size_t{1} << 46); }, part,
                          ExitCode::no_device);
}

TEST(Runtime, OutOfMemoryErrorNamesTheModelSize) {
  Runtime runtime(choose_device(""));
  testing::expect_error([&] { Model(runtime, ModelSpec{}, 65536, 200, Model::Use::training); },
                        "65536 sequences of 200 steps with windows of 10 x 32 x 32",
                        ExitCode::no_device);
}

TEST(Runtime, CountsMemoryUntilItIsReleased) {
  Runtime runtime(choose_device(""));
  if (runtime.device().type != "cpu") GTEST_SKIP() << "the driver counts";
  // OpenCL guarantees single buffers of a quarter of the memory only
  const auto fifth = static_cast<std::size_t>(runtime.device().memory_bytes / 5);
  for (int i = 0; i < 6; ++i) EXPECT_NO_THROW(runtime.allocate<char>(fifth)) << i;
  std::vector<Buffer<char>> held;
  for (int i = 0; i < 4; ++i) held.push_back(runtime.allocate<char>(fifth));
  EXPECT_THROW(runtime.allocate<char>(fifth + (1 << 20)), Error);
}

/// Size of this process's address space [pages].
long mapped_pages() {
  long pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages;
}

TEST(Runtime, ReleasesMemory) {
  Runtime runtime(choose_device(""));
  if (runtime.device().type != "cpu") GTEST_SKIP() << "its buffers are not in this process";
  constexpr std::size_t floats = 16u << 20;  // 64 MiB
  runtime.allocate<float>(floats);
  const long before = mapped_pages();
  for (int i = 0; i < 20; ++i) runtime.allocate<float>(floats);
  EXPECT_LT((mapped_pages() - before) * sysconf(_SC_PAGESIZE), 3 * long(floats * sizeof(float)));
}

TEST(Runtime, BuildErrorNamesKernelDefinesDeviceAndLog) {
  Runtime runtime(choose_device(""));
  const auto message = testing::expect_error(
      [&] {
        runtime.create(
            runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak", {{"REAL", "nonsense"}}));
      },
      runtime.device().name, {});
  for (const auto* part : {"the kernel fma_peak of", "fma_peak.cl", "-D REAL=nonsense",
                           "unknown type name", "nonsense16"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

/// Sum of `values` in their own type.
template <class T>
Launch sum_in(Runtime& runtime, const char* type, const std::vector<T>& values,
              const Buffer<T>& total) {
  return Launch(runtime.kernel({"common.clh", "sum.cl"}, "sum", {{"REAL", type}}), range(1),
                runtime.upload<T>(values), static_cast<int>(values.size()), total);
}

TEST(Runtime, ModulesOfAProgramHaveSeparateNamesAndMacros) {
  Runtime runtime(choose_device(""));
  const auto total = runtime.allocate<float>(1);
  const auto double_total = runtime.allocate<double>(1);
  const auto sum = sum_in<float>(runtime, "float", {1.0f, 2.0f}, total);
  const auto double_sum = sum_in<double>(runtime, "double", {1.0, 0x1p-50}, double_total);
  sum.enqueue(runtime), double_sum.enqueue(runtime);
  EXPECT_EQ(runtime.download(total)[0], 3.0f);
  EXPECT_EQ(runtime.download(double_total)[0], 1.0 + 0x1p-50);
}

TEST(Runtime, FailedBuildDoesNotAffectOtherKernels) {
  Runtime runtime(choose_device(""));
  const auto broken =
      runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak", {{"REAL", "nonsense"}});
  const auto sum = runtime.kernel({"common.clh", "sum.cl"}, "sum");
  EXPECT_NO_THROW(runtime.create(sum));
  EXPECT_THROW(runtime.create(broken), Error);
  const auto later = runtime.kernel({"common.clh", "adam.cl"}, "adam");
  EXPECT_NO_THROW(runtime.create(later));
  EXPECT_NO_THROW(runtime.create(sum));
  EXPECT_THROW(runtime.create(broken), Error);
}

TEST(Runtime, BuildsRegisteredKernelsInOneProgram) {
  Runtime runtime(choose_device(""));
  const auto program_of = [&](const Kernel& kernel) {
    return runtime.create(kernel).getInfo<CL_KERNEL_PROGRAM>();
  };
  const auto sum = runtime.kernel({"common.clh", "sum.cl"}, "sum");
  const auto adam = runtime.kernel({"common.clh", "adam.cl"}, "adam");
  const auto norm = runtime.kernel({"common.clh", "adam.cl"}, "norm");
  EXPECT_EQ(program_of(sum)(), program_of(adam)());
  EXPECT_EQ(program_of(norm)(), program_of(adam)());
}

TEST(CompilerProcess, LaunchesKernelsWithDummyArguments) {
  const auto number = choose_device("").info.number;
  const auto source =
      combined_source({{{"common.clh", "adam.cl"}, {}},
                       {{"common.clh", "tactile_window.cl"},
                        {{"WINDOW", "10"}, {"ROWS", "32"}, {"COLS", "32"}, {"LANES", "16"}}}});
  const std::vector<std::string> kernels{"squares__0", "norm__0", "adam__0", "tactile_window__1"};
  EXPECT_NO_THROW(compile_kernels({number, "-cl-kernel-arg-info", source, kernels}));
  EXPECT_THROW(compile_kernels({number, "-cl-kernel-arg-info", source, {"absent__0"}}), cl::Error);
}

TEST(Runtime, LaunchErrorNamesTheKernel) {
  Runtime runtime(choose_device(""));
  auto kernel = runtime.create(runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak"));
  for (const auto* part : {"fma_peak", "CL_INVALID_KERNEL_ARGS"})
    testing::expect_error([&] { runtime.launch(kernel, cl::NDRange(16), cl::NDRange(1)); }, part,
                          {});
}

}  // namespace
}  // namespace touchtrace
