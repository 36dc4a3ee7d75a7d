// Loss and gradient of the whole model against the double reference.
#include "engine/model/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/error.h"
#include "engine/check/operation_check.h"
#include "engine/train/noise_batch.h"
#include "tests/engine/small_spec.h"
#include "tests/verify/engine/model_comparison.h"

namespace touchtrace {
namespace {

using testing::small_spec;
using testing::with_gru;

std::vector<double> slice(const std::vector<double>& flat, const Parameter& row) {
  const auto begin = flat.begin() + std::ptrdiff_t(row.offset);
  return {begin, begin + std::ptrdiff_t(row.size)};
}

void expect_agreement(const ModelSpec& spec, const TaxelDropout& dropout,
                      std::optional<KernelVariant> body = {}) {
  Runtime runtime(choose_device(""), Accuracy::fast, body);
  const auto result = compare_model(runtime, spec, 5, 20, dropout, 3);
  EXPECT_LE(result.loss_error(), 1e-5);
  EXPECT_LE(result.gradient_error(), 1e-5);
  for (const auto& row : result.table.rows())
    EXPECT_LE(norm_error(slice(result.device.gradient, row), slice(result.reference.gradient, row)),
              5e-5)
        << row.name;
}

TEST(Model, LossAndGradientMatchReference) { expect_agreement(small_spec(true), {}); }

TEST(Model, LossAndGradientMatchReferenceWithTaxelDropout) {
  expect_agreement(small_spec(true), {0.3, 77});
}

TEST(Model, LossAndGradientMatchReferenceWithoutTouch) { expect_agreement(small_spec(false), {}); }

TEST(Model, LossAndGradientMatchReferenceWithSmoothActivations) {
  for (const auto activation : {Activation::silu, Activation::tanh}) {
    auto spec = small_spec(true);
    spec.activation = activation;
    expect_agreement(spec, {});
  }
}

TEST(Model, LossAndGradientMatchReferenceWithGru) {
  expect_agreement(with_gru(small_spec(true)), {0.3, 77});
  expect_agreement(with_gru(small_spec(false)), {});
  expect_agreement(with_gru(small_spec(ObjectEncoder::joint)), {});
}

TEST(Model, LossAndGradientMatchReferenceWithJointObjectEncoder) {
  expect_agreement(small_spec(ObjectEncoder::joint), {0.3, 77});
}

TEST(Model, LossAndGradientMatchReferenceWithNormalisedObjectEmbeddings) {
  expect_agreement(small_spec(ObjectEncoder::joint, 0.1f), {});
}

TEST(Model, LossAndGradientMatchReferenceWithOtherConvolutions) {
  expect_agreement(small_spec(5, {2, 1, 2}), {0.3, 77});
}

TEST(Model, LossAndGradientMatchReferenceWithFewTaxels) {
  for (const auto& [rows, cols] : {std::pair(1, 1), {1, 19}, {4, 4}})
    for (const auto variant : {KernelVariant::cpu, KernelVariant::gpu}) {
      auto spec = small_spec(ObjectEncoder::joint);
      spec.rows = rows, spec.cols = cols;
      expect_agreement(spec, {0.3, 77}, variant);
      spec.tactile_kernel = 5;
      expect_agreement(spec, {}, variant);
    }
}

TEST(Model, LossAndGradientMatchReferenceWithGpuKernels) {
  expect_agreement(small_spec(ObjectEncoder::joint), {0.3, 77}, KernelVariant::gpu);
}

class ReferenceGradient : public ::testing::TestWithParam<ModelSpec> {};

TEST_P(ReferenceGradient, MatchesCentralDifferences) {
  Runtime runtime(choose_device(""));
  const auto spec = GetParam();
  const auto result = compare_model(runtime, spec, 5, 20, {}, 3);
  RandomStream random(1, "direction");
  const auto direction = normal_floats(result.parameters.size(), random);
  constexpr double step = 1e-8;
  const auto loss_at = [&](double distance) {
    auto moved = result.parameters;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += distance * direction[i];
    return model_reference(spec, result.table, moved, result.problem).loss;
  };
  double expected = 0.0, norm = 0.0;
  for (std::size_t i = 0; i < direction.size(); ++i) {
    expected += result.reference.gradient[i] * direction[i];
    norm += std::pow(result.reference.gradient[i], 2);
  }
  // Rounding of the loss over twice the step: 1e-16 * 3 / 2e-8, about 2e-8 for a slope of 1.
  EXPECT_NEAR((loss_at(step) - loss_at(-step)) / (2 * step), expected, 1e-6 * std::sqrt(norm));
}

INSTANTIATE_TEST_SUITE_P(Model, ReferenceGradient,
                         ::testing::Values(small_spec(true), small_spec(ObjectEncoder::joint),
                                           small_spec(ObjectEncoder::joint, 0.1f),
                                           small_spec(5, {2, 1, 2}),
                                           with_gru(small_spec(ObjectEncoder::joint))));

TEST(Model, HasNoTactileParametersWithoutTouch) {
  Runtime runtime(choose_device(""));
  const Model model(runtime, small_spec(false), 2, 3, Model::Use::training);
  for (const auto& row : model.table().rows()) EXPECT_FALSE(row.name.starts_with("tactile"));
  EXPECT_EQ(model.table().at("dynamics.0.weight").shape, (std::vector<int>{64, 5}));
}

TEST(Model, HasObjectEncoderOnlyIfTrainedJointly) {
  Runtime runtime(choose_device(""));
  const auto has_encoder = [&](ObjectEncoder object, Model::Use use) {
    const Model model(runtime, small_spec(object), 2, 3, use);
    EXPECT_EQ(model.table().at("dynamics.0.weight").shape.back(),
              object == ObjectEncoder::none ? 5 + 16 : 5 + 16 + 16);
    return std::ranges::any_of(model.table().rows(),
                               [](const auto& row) { return row.name.starts_with("object."); });
  };
  for (const auto use : {Model::Use::prediction, Model::Use::training}) {
    EXPECT_FALSE(has_encoder(ObjectEncoder::none, use));
    EXPECT_FALSE(has_encoder(ObjectEncoder::frozen, use));
  }
  EXPECT_TRUE(has_encoder(ObjectEncoder::joint, Model::Use::training));
  EXPECT_FALSE(has_encoder(ObjectEncoder::joint, Model::Use::prediction));
}

TEST(Model, RejectsInvalidSpecs) {
  Runtime runtime(choose_device(""));
  const std::vector<std::function<void(ModelSpec&)>> changes{
      [](ModelSpec& s) { s.hidden = 100; },
      [](ModelSpec& s) { s.state = 17; },
      [](ModelSpec& s) { s.embedding = 20; },
      [](ModelSpec& s) { s.rows = 0; },
      [](ModelSpec& s) { s.rows = 0, s.touch = false; },
      [](ModelSpec& s) { s.tactile_kernel = 4; },
      [](ModelSpec& s) { s.tactile_strides[1] = 3; },
      [](ModelSpec& s) { s.band_quantile = 0.0; },
      [](ModelSpec& s) { s.band_quantile = 0.5; },
      [](ModelSpec& s) { s.band_quantile = std::nan(""); },
      [](ModelSpec& s) { s.object = ObjectEncoder::joint, s.touch = false; },
      [](ModelSpec& s) { s.object = ObjectEncoder::joint, s.segment_frames = 33; }};
  for (const auto& change : changes) {
    auto spec = small_spec(true);
    change(spec);
    EXPECT_THROW(Model(runtime, spec, 2, 3, Model::Use::training), Error);
  }
}

}  // namespace
}  // namespace touchtrace
