// What Accuracy::exact is for, and what Accuracy::fast gives up.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/ops/adam.h"
#include "engine/ops/dense.h"
#include "engine/ops/sum.h"

namespace touchtrace {
namespace {

class AccuracyTest : public ::testing::Test {
 protected:
  /// The kernel that adds up losses.
  static float sum(Runtime& runtime, const std::vector<float>& values) {
    const auto total = runtime.allocate<float>(1);
    const auto launch = touchtrace::sum(runtime, runtime.upload<float>(values), total);
    launch.enqueue(runtime);
    return runtime.download(total)[0];
  }

  /// A parameter of 1 after `count` steps of `rate`: the same gradient always makes them that long.
  static float after_steps(Runtime& runtime, int count, double rate) {
    const auto parameter = upload(runtime, {1.0});
    Adam adam(runtime, parameter, upload(runtime, {0.5}), upload(runtime, {0.0}),
              upload(runtime, {1.0}));
    for (int step = 1; step <= count; ++step) adam.enqueue({step, rate, 1e6});
    return runtime.download(parameter)[0];
  }

  /// Of tenths and ones, by the GEMM.
  static constexpr int terms = 1 << 18;
  static float inner_product(Runtime& runtime) {
    const auto tenths = runtime.upload<float>(std::vector<float>(terms, 0.1f)),
               ones = runtime.upload<float>(std::vector<float>(std::size_t(terms) * 16, 1.0f)),
               result = runtime.allocate<float>(16);
    gemm(runtime, {tenths, 0, terms}, {ones, 0, 16}, {}, {result, 0, 16}, 1, 16, terms)
        .enqueue(runtime);
    return runtime.download(result)[0];
  }

  Runtime fast_{choose_device(""), Accuracy::fast}, exact_{choose_device(""), Accuracy::exact};
};

TEST_F(AccuracyTest, LongSumsKeepTheirDigits) {
  const std::vector<float> tenths(1'000'000, 0.1f);
  const double right = 1e6 * double(0.1f);
  EXPECT_GT(std::abs(sum(fast_, tenths) / right - 1.0), 1e-5) << "nothing to compensate here";
  EXPECT_LE(std::abs(sum(exact_, tenths) / right - 1.0), 1.2e-7);
}

TEST_F(AccuracyTest, InnerProductsKeepTheirDigits) {
  const double right = terms * double(0.1f);
  EXPECT_GT(std::abs(inner_product(fast_) / right - 1.0), 1e-6) << "nothing to compensate here";
  EXPECT_LE(std::abs(inner_product(exact_) / right - 1.0), 1.2e-7);
}

TEST_F(AccuracyTest, SmallStepsAddUp) {
  const double right = 1.0 - 1000 * 2e-8;
  EXPECT_EQ(after_steps(fast_, 1000, 2e-8), 1.0f) << "nothing to compensate here";
  EXPECT_LE(std::abs(after_steps(exact_, 1000, 2e-8) - right), 1.2e-7);
}

TEST_F(AccuracyTest, DenormalsAreKept) {
  const std::vector<float> denormals(1000, 1e-41f);
  EXPECT_EQ(sum(fast_, denormals), 0.0f) << "denormals are slow, and should be flushed";
  EXPECT_NEAR(sum(exact_, denormals) / (1000 * double(1e-41f)), 1.0, 1e-6);
}

}  // namespace
}  // namespace touchtrace
