// Compensated sums and denormals of Accuracy::exact, and their absence in Accuracy::fast, for both
// kernel variants.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/ops/adam.h"
#include "engine/ops/conv2d.h"
#include "engine/ops/dense.h"
#include "engine/ops/sum.h"

namespace touchtrace {
namespace {

class AccuracyTest : public ::testing::TestWithParam<KernelVariant> {
 protected:
  void SetUp() override {
    if (GetParam() == KernelVariant::gpu && !supports_gpu_variant(fast_.device()))
      GTEST_SKIP() << "the device does not support the GPU kernels";
  }

  static float sum(Runtime& runtime, const std::vector<float>& values) {
    const auto total = runtime.allocate<float>(1);
    const auto launch = touchtrace::sum(runtime, runtime.upload<float>(values), total);
    launch.enqueue(runtime);
    return runtime.download(total)[0];
  }

  /// A parameter of 1 after `count` steps of length `rate`, which a constant gradient makes.
  static float after_steps(Runtime& runtime, int count, double rate) {
    const auto parameter = upload(runtime, {1.0});
    Adam adam(runtime, parameter, upload(runtime, {0.5}), upload(runtime, {0.0}),
              upload(runtime, {1.0}));
    for (int step = 1; step <= count; ++step) adam.enqueue({step, rate, 1e6});
    return runtime.download(parameter)[0];
  }

  /// Inner product of 0.1 and 1, computed by gemm().
  static constexpr int terms = 1 << 18;
  static float inner_product(Runtime& runtime) {
    const auto tenths = runtime.upload<float>(std::vector<float>(terms, 0.1f)),
               ones = runtime.upload<float>(std::vector<float>(std::size_t(terms) * 16, 1.0f)),
               result = runtime.allocate<float>(16);
    enqueue(runtime,
            gemm(runtime, {tenths, 0, terms}, {ones, 0, 16}, {}, {result, 0, 16}, 1, 16, terms));
    return runtime.download(result)[0];
  }

  /// A layer with input 0.1 and weights 0.1, as many as `shape` has, and no bias.
  struct Layer {
    Layer(Runtime& runtime, const Conv2dShape& shape, Conv2dMethod method = Conv2dMethod::direct)
        : parameters{upload(runtime, weights(shape)),
                     runtime.allocate_zeros<float>(shape.weight_size() + shape.out_channels), 0,
                     static_cast<int>(shape.weight_size())},
          conv(make_conv2d(runtime, shape, parameters, method)) {
      const std::vector<double> in(std::size_t(shape.in_channels) * shape.rows * shape.cols, 0.1f);
      const HaloLayout layout{shape.rows, shape.cols, shape.in_planes ? 1 : 16, shape.halo()};
      images = {1,
                upload(runtime, with_halo(in, layout)),
                runtime.allocate_zeros<float>(shape.out_size()),
                upload(runtime, std::vector<double>(shape.grad_out_size(), 0.1f)),
                {}};
      enqueue(runtime, conv->prepare());
    }
    static std::vector<double> weights(const Conv2dShape& shape) {
      std::vector<double> values(shape.weight_size() + shape.out_channels, 0.0);
      std::fill_n(values.begin(), shape.weight_size(), 0.1f);
      return values;
    }

    Conv2dParameters parameters;
    std::unique_ptr<Conv2d> conv;
    Conv2dMicroBatch images;
  };

  /// An output value, from 4608 equal terms.
  static float convolution(Runtime& runtime) {
    const Conv2dShape shape{1, 512, 8, 8, 32, false};
    Layer layer(runtime, shape);
    enqueue(runtime, layer.conv->forward(layer.images));
    const HaloLayout layout{shape.out_rows(), shape.out_cols(), 16, shape.halo()};
    const auto out = without_halo(download(runtime, layer.images.out), layout);
    return static_cast<float>(out[std::size_t(shape.out_cols()) + 1]);  // no tap in the halo
  }

  /// The gradient of a weight, from 4096 equal terms.
  static float weight_gradient(Runtime& runtime) {
    Layer layer(runtime, {1, 1, 128, 128, 32, true});
    enqueue(runtime, layer.conv->backward(layer.images, true));
    enqueue(runtime, layer.conv->finish());
    return static_cast<float>(download(runtime, layer.parameters.gradient)[4]);  // centre tap
  }

  Runtime fast_{choose_device(""), Accuracy::fast, GetParam()},
      exact_{choose_device(""), Accuracy::exact, GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Variants, AccuracyTest,
                         ::testing::Values(KernelVariant::cpu, KernelVariant::gpu),
                         [](const auto& variant) {
                           return variant.param == KernelVariant::cpu ? "Cpu" : "Gpu";
                         });

// A correctly rounded float is within 6e-8 of its value; the bound of the exact results is two of
// these. Each fast result must err by more, or the test would not show any compensation.
constexpr double exact_bound = 1.2e-7;

double relative_error(double value, double expected) { return std::abs(value / expected - 1.0); }

TEST_P(AccuracyTest, LongSumsAreCompensated) {
  const std::vector<float> tenths(1'000'000, 0.1f);
  const double expected = 1e6 * double(0.1f);
  EXPECT_GT(relative_error(sum(fast_, tenths), expected), 1e-5);
  EXPECT_LE(relative_error(sum(exact_, tenths), expected), exact_bound);
}

TEST_P(AccuracyTest, MatrixProductsAreCompensated) {
  const double expected = terms * double(0.1f);
  EXPECT_GT(relative_error(inner_product(fast_), expected), 1e-6);
  EXPECT_LE(relative_error(inner_product(exact_), expected), exact_bound);
}

TEST_P(AccuracyTest, ConvolutionsAreCompensated) {
  const double expected = 4608 * double(0.1f) * double(0.1f);
  EXPECT_GT(relative_error(convolution(fast_), expected), 2 * exact_bound);
  EXPECT_LE(relative_error(convolution(exact_), expected), exact_bound);
}

TEST_P(AccuracyTest, WeightGradientsAreCompensated) {
  const double expected = 4096 * double(0.1f) * double(0.1f);
  EXPECT_GT(relative_error(weight_gradient(fast_), expected), 2 * exact_bound);
  EXPECT_LE(relative_error(weight_gradient(exact_), expected), exact_bound);
}

TEST_P(AccuracyTest, ExactNeverUsesWinograd) {
  const Conv2dShape shape{1, 32, 8, 8, 32, false};
  const auto kernel_of = [&](Runtime& runtime) {
    Layer layer(runtime, shape, Conv2dMethod::winograd);
    return layer.conv->forward(layer.images).front().name();
  };
  const bool cpu = GetParam() == KernelVariant::cpu;
  EXPECT_EQ(kernel_of(fast_), cpu ? "winograd_forward" : "conv2d_gpu_forward");
  EXPECT_EQ(kernel_of(exact_), cpu ? "conv2d_forward" : "conv2d_gpu_forward");
}

TEST_P(AccuracyTest, SmallStepsAccumulate) {
  const double expected = 1.0 - 1000 * 2e-8;
  EXPECT_EQ(after_steps(fast_, 1000, 2e-8), 1.0f);
  EXPECT_LE(std::abs(after_steps(exact_, 1000, 2e-8) - expected), exact_bound);
}

TEST_P(AccuracyTest, DenormalsAreFlushedOnlyInFast) {
  const std::vector<float> denormals(1000, 1e-41f);
  EXPECT_EQ(sum(fast_, denormals), 0.0f);
  EXPECT_NEAR(sum(exact_, denormals) / (1000 * double(1e-41f)), 1.0, 1e-6);
}

}  // namespace
}  // namespace touchtrace
