// The whole model's loss and gradient against the composition of the double-precision references.
#include "engine/model/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/error.h"
#include "engine/model/model_reference.h"
#include "engine/train/batch_rows.h"
#include "tests/engine/rollout_problem.h"

namespace touchtrace {
namespace {

using testing::noise_batch;
using testing::noise_stream;
using testing::small_spec;

constexpr int sequences = 5, steps = 20, frames = 60;

std::vector<double> as_double(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

/// A model on the device with a batch uploaded, and the same as doubles.
struct Problem {
  explicit Problem(bool touch)
      : runtime(choose_device("")),
        model(runtime, small_spec(touch), sequences, steps, Model::Use::training),
        random(5, "model test"),
        stream(noise_stream(model.spec(), frames, random)),
        weights(model.table().initial_values(3)) {
    const auto batch = noise_batch(model.spec(), sequences, steps, frames, random);
    write_windows(runtime, model, {batch}, frames);
    write_initial_states(runtime, model, {batch}, batch.initial_state);
    write_targets(runtime, model, batch);
    runtime.write<float>(model.weights().values, weights);
    plain = {sequences, steps, as_double(stream), {}, as_double(batch.initial_state), {}, {}, {}};
    if (touch) plain.last_frame = runtime.download(model.input().last_frame);
    plain.weight = as_double(runtime.download(model.input().weight));
    for (int t = 0; t < steps; ++t)
      for (int s = 0; s < sequences; ++s) {
        const auto* row = &batch.target[(std::size_t(s) * steps + t) * model.spec().state];
        plain.target.insert(plain.target.end(), row, row + model.spec().state);
      }
  }

  LossAndGradient on_device() {
    model.prepare();
    model.forward(runtime.upload<float>(stream), plain.dropout);
    model.backward();
    return {runtime.download(model.loss())[0],
            as_double(runtime.download(model.weights().gradient))};
  }
  LossAndGradient in_double() {
    return model_reference(model.spec(), model.table(), as_double(weights), plain);
  }

  Runtime runtime;
  Model model;
  RandomStream random;
  std::vector<float> stream, weights;
  ModelProblem plain;
};

double norm(const std::vector<double>& values) {
  double sum = 0.0;
  for (double v : values) sum += v * v;
  return std::sqrt(sum);
}

/// Relative, in norm; NaN if the device gives one.
double distance(const std::vector<double>& a, std::vector<double> reference) {
  const double scale = norm(reference);
  for (std::size_t i = 0; i < reference.size(); ++i) reference[i] -= a.at(i);
  return norm(reference) / scale;
}

void expect_agreement(Problem& problem) {
  const auto device = problem.on_device(), plain = problem.in_double();
  EXPECT_LE(std::abs(device.loss - plain.loss), 1e-5 * plain.loss);
  EXPECT_LE(distance(device.gradient, plain.gradient), 1e-5);
  for (const auto& row : problem.model.table().rows()) {
    const auto part = [&](const std::vector<double>& all) {
      const auto begin = all.begin() + std::ptrdiff_t(row.offset);
      return std::vector<double>(begin, begin + std::ptrdiff_t(row.size));
    };
    EXPECT_GT(norm(part(plain.gradient)), 0.0) << row.name;
    EXPECT_LE(distance(part(device.gradient), part(plain.gradient)), 5e-5) << row.name;
  }
}

TEST(Model, LossAndGradientOfARolloutAgreeWithDouble) {
  Problem problem(true);
  expect_agreement(problem);
}

TEST(Model, LossAndGradientAgreeWithTaxelsBlanked) {
  Problem problem(true);
  problem.plain.dropout = {0.3, 77};
  expect_agreement(problem);
}

TEST(Model, LossAndGradientAgreeWithoutTouch) {
  Problem problem(false);
  expect_agreement(problem);
}

TEST(Model, ReferenceGradientAgreesWithCentralDifferences) {
  Problem problem(true);
  const auto gradient = problem.in_double().gradient;
  auto direction = as_double(testing::normal_floats(gradient.size(), problem.random));
  double expected = 0.0, length = norm(direction);
  for (std::size_t i = 0; i < direction.size(); ++i)
    expected += gradient[i] * direction[i] / length;
  const auto loss_at = [&](double step) {
    auto moved = as_double(problem.weights);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += step * direction[i] / length;
    return model_reference(problem.model.spec(), problem.model.table(), moved, problem.plain).loss;
  };
  constexpr double step = 1e-6;
  EXPECT_NEAR((loss_at(step) - loss_at(-step)) / (2 * step), expected,
              1e-5 * norm(gradient) / std::sqrt(double(gradient.size())));
}

TEST(Model, WithoutTouchHasNoTactileParameters) {
  Runtime runtime(choose_device(""));
  const Model model(runtime, small_spec(false), 2, 3, Model::Use::training);
  for (const auto& row : model.table().rows()) EXPECT_FALSE(row.name.starts_with("tactile"));
  EXPECT_EQ(model.table().at("dynamics.0.weight").shape, (std::vector<int>{64, 5}));
}

TEST(Model, RefusesSizesThatTheKernelsDoNotTake) {
  Runtime runtime(choose_device(""));
  for (auto change : std::vector<std::function<void(ModelSpec&)>>{
           [](ModelSpec& s) { s.hidden = 100; }, [](ModelSpec& s) { s.state = 17; },
           [](ModelSpec& s) { s.embedding = 20; }, [](ModelSpec& s) { s.rows = 5; }}) {
    auto spec = small_spec(true);
    change(spec);
    EXPECT_THROW(Model(runtime, spec, 2, 3, Model::Use::training), Error);
  }
}

}  // namespace
}  // namespace touchtrace
