#include "engine/train/predictor.h"

#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/train/safetensors.h"
#include "tests/engine/trainer_fixture.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::NoiseRun;
using testing::small_spec;

class PredictorTest : public testing::TrainerTest {
 protected:
  std::filesystem::path model(bool touch) { return model(small_spec(touch)); }
  std::filesystem::path model(const ModelSpec& spec) {
    NoiseRun run(runtime_, spec);
    run.train_until(3);
    run.trainer.save(folder_ / "model", {}, true);
    return folder_ / "model";
  }
};

void expect_finite(const Rollout& rollout) {
  for (float value : rollout.state) ASSERT_TRUE(std::isfinite(value));
  for (float value : rollout.spread) {
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_GE(value, 0.0f);
  }
}

TEST_F(PredictorTest, AcceptsAnyNumberOfSequencesAndSteps) {
  const auto spec = small_spec(true);
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 520, random);
  Predictor predictor(runtime_, model(true));
  for (const auto& [sequences, steps] : {std::pair{1, 1}, {1, 500}, {3, 21}, {70, 45}, {32, 20}}) {
    const auto batch = noise_batch(spec, sequences, steps, 520, random);
    const auto rollout = predictor.predict(batch, stream);
    EXPECT_EQ(rollout.state.size(), std::size_t(sequences) * steps * spec.state);
    expect_finite(rollout);
  }
  EXPECT_TRUE(predictor.predict({}, stream).state.empty());
}

class PredictorBlocks : public PredictorTest, public ::testing::WithParamInterface<DynamicsKind> {};

TEST_P(PredictorBlocks, SequencesDoNotAffectEachOther) {
  auto spec = small_spec(true);
  spec.dynamics = GetParam();
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 200, random);
  Predictor predictor(runtime_, model(spec));
  const int steps = 47;
  const auto batch = noise_batch(spec, 70, steps, 200, random);
  const auto together = predictor.predict(batch, stream);
  for (int s : {0, 31, 32, 69}) {
    RolloutBatch alone;
    alone.sequences = 1, alone.steps = steps, alone.first_frame = {batch.first_frame[s]};
    const auto* initial = &batch.initial_state[std::size_t(s) * spec.state];
    alone.initial_state.assign(initial, initial + spec.state);
    const auto rollout = predictor.predict(alone, stream);
    const auto at = std::ptrdiff_t(s) * steps * spec.state;
    EXPECT_TRUE(
        std::equal(rollout.state.begin(), rollout.state.end(), together.state.begin() + at));
    EXPECT_TRUE(
        std::equal(rollout.spread.begin(), rollout.spread.end(), together.spread.begin() + at));
  }
}

INSTANTIATE_TEST_SUITE_P(Dynamics, PredictorBlocks,
                         ::testing::Values(DynamicsKind::mlp, DynamicsKind::gru));

TEST_F(PredictorTest, NeedsNoStreamWithoutTouch) {
  RandomStream random(3, "batch");
  auto batch = noise_batch(small_spec(false), 4, 30, 100, random);
  batch.first_frame.clear();
  expect_finite(Predictor(runtime_, model(false)).predict(batch, {}));
}

TEST_F(PredictorTest, RejectsWindowsOutsideTheStream) {
  const auto spec = small_spec(true);
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 30, random);
  Predictor predictor(runtime_, model(true));
  auto batch = noise_batch(spec, 2, 10, 30, random);
  batch.first_frame[1] = 21;
  EXPECT_THROW(predictor.predict(batch, stream), Error);
  EXPECT_THROW(predictor.predict(batch, {}), Error);
}

TEST_F(PredictorTest, ReadsModelsWithoutQuantileAndConvolutions) {
  auto file = read_safetensors(model(true));
  auto spec = nlohmann::json::parse(file.metadata["spec"]);
  for (const char* key : {"band_quantile", "tactile_kernel", "tactile_strides"})
    EXPECT_EQ(spec.erase(key), 1u);
  file.metadata["spec"] = spec.dump();
  write_safetensors(folder_ / "old", file, true);
  const auto read = Predictor(runtime_, folder_ / "old").spec();
  EXPECT_EQ(read.band_quantile, 0.1);
  EXPECT_EQ(read.tactile_kernel, 3);
  EXPECT_EQ(read.tactile_strides, (std::array{2, 2, 2}));
}

TEST(ModelSpec, RoundTripsThroughJson) {
  const auto spec = small_spec(5, {1, 2, 1});
  const auto read = nlohmann::json::parse(nlohmann::json(spec).dump()).get<ModelSpec>();
  EXPECT_EQ(read.tactile_kernel, 5);
  EXPECT_EQ(read.tactile_strides, spec.tactile_strides);
}

TEST_F(PredictorTest, RejectsFilesThatAreNotModels) {
  write_safetensors(folder_ / "empty", {}, false);
  EXPECT_THROW(Predictor(runtime_, folder_ / "empty"), Error);
  auto file = read_safetensors(model(true));
  const auto spec = file.metadata["spec"];
  for (const std::string bad : {"", "7", "{", "{}", R"({"touch":3})"}) {
    file.metadata["spec"] = bad;
    write_safetensors(folder_ / "bad", file, true);
    EXPECT_THROW(Predictor(runtime_, folder_ / "bad"), Error) << bad;
  }
  file.metadata["spec"] = spec;
  auto& value = file.tensors.front().values.back();
  const float finite = value;
  for (const float bad : {NAN, INFINITY}) {
    value = bad;
    EXPECT_THROW(Predictor(runtime_, file), Error) << bad;
  }
  value = finite;
  EXPECT_NO_THROW(Predictor(runtime_, file));
  file.tensors.pop_back();
  write_safetensors(folder_ / "bad", file, true);
  EXPECT_THROW(Predictor(runtime_, folder_ / "bad"), Error);
}

/// Message of the error that a model with another value of a key in its specification causes.
std::string spec_error(Runtime& runtime, TensorFile file, const std::filesystem::path& path,
                       const std::string& key, const std::string& value) {
  auto spec = nlohmann::json::parse(file.metadata["spec"]);
  spec[key] = "VALUE";
  std::string text = spec.dump();
  text.replace(text.find("\"VALUE\""), 7, value);  // dump() would recurse into nested values
  file.metadata["spec"] = text;
  write_safetensors(path, file, true);
  SCOPED_TRACE(key + " " + value.substr(0, 50));
  return testing::expect_error([&] { Predictor(runtime, path); }, "'" + key + "'");
}

TEST_F(PredictorTest, NamesFileKeyValueAndRangeOfAnInvalidSpec) {
  const auto path = folder_ / "crafted";
  const std::vector<std::array<std::string, 3>> cases{
      {"rows", "0", "1..64"},
      {"rows", "65", "1..64"},
      {"cols", "-1", "1..64"},
      {"cols", "4294967302", "1..64"},  // 6 in 32 bits
      {"cols", "18446744073709551615", "1..64"},
      {"rows", "9.5", "1..64"},
      {"rows", "1e300", "1..64"},
      {"rows", "\"9\"", "1..64"},
      {"window_frames", "33", "1..32"},
      {"tactile_kernel", "4", "3..5"},
      {"tactile_strides", "[2,2]", "1 or 2"},
      {"tactile_strides", "[2,2,3]", "1 or 2"},
      {"embedding", "24", "16..1024"},
      {"hidden", "0", "64..1024"},
      {"state", "17", "1..16"},
      {"band_quantile", "0.5", "between 0 and 0.5"},
      {"band_quantile", "null", "between 0 and 0.5"},
      {"dynamics", "\"lstm\"", "'mlp'"},
      {"activation", "\"step\"", "'relu'"},
      {"object", "\"known\"", "'none'"},
      {"touch", "1", "true or false"}};
  for (const bool touch : {false, true}) {
    const auto file = read_safetensors(model(touch));
    for (const auto& [key, value, range] : cases) {
      const auto message = spec_error(runtime_, file, path, key, value);
      for (const auto& word : {path.string(), range})
        EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
    }
    EXPECT_NE(spec_error(runtime_, file, path, "rows", "0").find("is 0;"), std::string::npos);
    const auto nested = std::string(100'000, '[') + std::string(100'000, ']');
    spec_error(runtime_, file, path, "rows", nested);
  }
}

}  // namespace
}  // namespace touchtrace
