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

namespace touchtrace {
namespace {

/// The error that `call` throws; fails the test if it throws none.
template <class Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return failure("", "");
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Device, IsChosenByNumberTypeOrPartOfItsName) {
  const auto devices = list_devices();
  ASSERT_FALSE(devices.empty());
  const auto& last = devices.back();
  EXPECT_EQ(choose_device(std::to_string(last.number)).info.name, last.name);
  EXPECT_EQ(choose_device(last.type).info.type, last.type);
  EXPECT_EQ(choose_device(last.name.substr(1, 6)).info.name, last.name);
}

TEST(Device, ThatDoesNotExistIsAnErrorWithAList) {
  const auto error = error_of([] { choose_device("abacus"); });
  EXPECT_EQ(error.code(), ExitCode::no_device);
  EXPECT_TRUE(mentions(error.remedy(), list_devices().front().name)) << error.remedy();
}

TEST(SelfTest, TakesNoWrongValueNoNanAndNoFault) {
  OperationResult result;
  EXPECT_TRUE(result.holds());
  result.output_error = 1.01 * output_error_bound;
  EXPECT_FALSE(result.holds());
  result.output_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(result.holds());
  result.output_error = 0.0, result.fault = "it burns";
  EXPECT_FALSE(result.holds());
}

/// An operation y = x whose kernel errs by `error` in one value.
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

TEST(OperationCheck, FindsOneWrongValue) {
  Runtime runtime(choose_device(""));
  const auto inputs = draw_inputs(identity_off_by(0), 1);
  EXPECT_EQ(output_error(runtime, identity_off_by(0), inputs), 0.0);
  EXPECT_GT(output_error(runtime, identity_off_by(1e-5), inputs), output_error_bound);
  EXPECT_TRUE(std::isinf(output_error(runtime, identity_off_by(NAN), inputs)));
}

TEST(Runtime, SideQueueRunsBehindTheForkAndBeforeTheJoin) {
  constexpr std::size_t size = 1 << 16;
  Runtime runtime(choose_device(""));
  const auto values = runtime.allocate<float>(size), total = runtime.allocate<float>(1);
  const auto adding = sum(runtime, values, total);
  for (int turn = 1; turn <= 20; ++turn) {
    runtime.fill(values, static_cast<float>(turn));
    runtime.fork();
    runtime.on_side([&] { adding.enqueue(runtime); });
    runtime.join();
    EXPECT_EQ(runtime.download(total)[0], static_cast<float>(turn) * size);
  }
}

TEST(Runtime, SaysHowMuchMemoryWasWantedAndWhatLowersIt) {
  Runtime runtime(choose_device(""));
  const auto error = error_of([&] { runtime.allocate<float>(std::size_t{1} << 46); });
  EXPECT_EQ(error.code(), ExitCode::no_device);
  EXPECT_TRUE(mentions(error.what(), "268435456 MiB")) << error.what();
  EXPECT_TRUE(mentions(error.remedy(), "--sequences")) << error.remedy();
}

TEST(Runtime, SaysWhatTheMemoryWasWantedFor) {
  Runtime runtime(choose_device(""));
  const auto error =
      error_of([&] { Model(runtime, ModelSpec{}, 4096, 200, Model::Use::training); });
  EXPECT_EQ(error.code(), ExitCode::no_device);
  EXPECT_TRUE(mentions(error.what(), "4096 sequences of 200 steps with windows of 10 x 32 x 32"))
      << error.what();
}

TEST(Runtime, CountsMemoryUntilItIsFree) {
  Runtime runtime(choose_device(""));
  // a single buffer may be a quarter of all: OpenCL promises no more
  const auto fifth = static_cast<std::size_t>(runtime.device().memory_bytes / 5);
  for (int i = 0; i < 6; ++i) EXPECT_NO_THROW(runtime.allocate<char>(fifth)) << i;
  std::vector<Buffer<char>> held;
  for (int i = 0; i < 4; ++i) held.push_back(runtime.allocate<char>(fifth));
  EXPECT_THROW(runtime.allocate<char>(fifth + (1 << 20)), Error);
}

/// Pages of the address space of this process.
long mapped_pages() {
  long pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages;
}

TEST(Runtime, GivesMemoryBack) {
  Runtime runtime(choose_device(""));
  constexpr std::size_t floats = 16u << 20;  // 64 MiB
  runtime.allocate<float>(floats);
  const long before = mapped_pages();
  for (int i = 0; i < 20; ++i) runtime.allocate<float>(floats);
  EXPECT_LT((mapped_pages() - before) * sysconf(_SC_PAGESIZE), 3 * long(floats * sizeof(float)));
}

TEST(Runtime, ShowsDeviceOptionsAndLogOfAKernelThatDoesNotBuild) {
  Runtime runtime(choose_device(""));
  const auto error = error_of([&] {
    runtime.create(
        runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak", {{"REAL", "nonsense"}}));
  });
  for (const auto* part : {"the kernel fma_peak of", "fma_peak.cl", "-D REAL=nonsense",
                           "unknown type name", "nonsense16"})
    EXPECT_TRUE(mentions(error.what(), part)) << error.what();
  EXPECT_TRUE(mentions(error.what(), runtime.device().name)) << error.what();
}

/// The sum of `values`, in their type.
template <class T>
Launch sum_in(Runtime& runtime, const char* type, const std::vector<T>& values,
              const Buffer<T>& total) {
  return Launch(runtime.kernel({"common.clh", "sum.cl"}, "sum", {{"REAL", type}}), range(1),
                runtime.upload<T>(values), static_cast<int>(values.size()), total);
}

TEST(Runtime, KeepsThePartsOfAProgramApart) {
  Runtime runtime(choose_device(""));
  const auto total = runtime.allocate<float>(1);
  const auto fine_total = runtime.allocate<double>(1);
  const auto sum = sum_in<float>(runtime, "float", {1.0f, 2.0f}, total);
  const auto fine_sum = sum_in<double>(runtime, "double", {1.0, 0x1p-50}, fine_total);
  sum.enqueue(runtime), fine_sum.enqueue(runtime);
  EXPECT_EQ(runtime.download(total)[0], 3.0f);
  EXPECT_EQ(runtime.download(fine_total)[0], 1.0 + 0x1p-50);
}

TEST(Runtime, BuildsWhatItWasAskedForTogether) {
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

TEST(CompilerProcess, LaunchesKernelsOnNothing) {
  const auto number = choose_device("").info.number;
  const auto source =
      joined_source({{{"common.clh", "adam.cl"}, {}},
                     {{"common.clh", "tactile_window.cl"},
                      {{"WINDOW", "10"}, {"ROWS", "32"}, {"COLS", "32"}, {"LANES", "16"}}}});
  const std::vector<std::string> kernels{"squares__0", "norm__0", "adam__0", "tactile_window__1"};
  EXPECT_NO_THROW(compile_kernels({number, "-cl-kernel-arg-info", source, kernels}));
  EXPECT_THROW(compile_kernels({number, "-cl-kernel-arg-info", source, {"absent__0"}}), cl::Error);
}

TEST(Runtime, SaysWhichKernelADeviceRefuses) {
  Runtime runtime(choose_device(""));
  auto kernel = runtime.create(runtime.kernel({"common.clh", "fma_peak.cl"}, "fma_peak"));
  const auto error = error_of([&] { runtime.launch(kernel, cl::NDRange(16), cl::NDRange(1)); });
  EXPECT_TRUE(mentions(error.what(), "fma_peak")) << error.what();
  EXPECT_TRUE(mentions(error.what(), "CL_INVALID_KERNEL_ARGS")) << error.what();
}

}  // namespace
}  // namespace touchtrace
