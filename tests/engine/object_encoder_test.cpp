// Contrastive training of the object encoder, frozen embeddings, and prediction with them.
#include <cmath>
#include <numeric>

#include "engine/base/error.h"
#include "engine/train/object_embedder.h"
#include "engine/train/object_trainer.h"
#include "engine/train/online_predictor.h"
#include "tests/engine/trainer_fixture.h"

namespace touchtrace {
namespace {

using testing::small_spec;
using testing::TrainerTest;

/// Clips of `clip` frames of three objects in turn: the pattern of the object, and noise.
struct Patterns {
  static constexpr int objects = 3, clip = 30, clips = 12;

  explicit Patterns(const ModelSpec& spec) {
    RandomStream random(7, "patterns");
    const int taxels = spec.rows * spec.cols;
    const auto pattern = normal_floats(std::size_t(objects) * taxels, random);
    for (int frame = 0; frame < clips * clip; ++frame)
      for (int i = 0; i < taxels; ++i)
        stream.push_back(pattern[object_of(frame) * taxels + i] + 0.1f * float(random.normal()));
  }
  static int object_of(int frame) { return frame / clip % objects; }

  SegmentBatch batch(const ModelSpec& spec, int segments, RandomStream& random) const {
    SegmentBatch batch;
    for (int i = 0; i < segments; ++i) {
      const int start = clip * int(random.below(clips));
      batch.first_frame.push_back(start + int(random.below(clip - spec.segment_frames + 1)));
      batch.object.push_back(object_of(start));
    }
    return batch;
  }

  std::vector<float> stream;
};

class ObjectEncoderTest : public TrainerTest {
 protected:
  TensorFile trained_encoder(int updates) {
    TrainOptions options;
    options.updates = updates;
    ObjectTrainer trainer(runtime_, spec_, options, 12, patterns_.stream);
    RandomStream random(1, "segments");
    first_loss_ = trainer.update(patterns_.batch(spec_, 12, random));
    while (trainer.updates() < updates)
      last_loss_ = trainer.update(patterns_.batch(spec_, 12, random));
    return {{}, trainer.weights()};
  }

  FrozenObjects frozen() {
    const auto encoder = trained_encoder(5);
    RandomStream random(2, "means");
    const auto batch = patterns_.batch(spec_, 24, random);
    ObjectEmbedder embedder(runtime_, spec_, encoder);
    const auto embeddings =
        embedder.embed(runtime_.upload<float>(patterns_.stream), batch.first_frame);
    return {encoder.tensors, mean_embeddings(embeddings, batch.object, Patterns::objects)};
  }

  RolloutBatch batch(int steps, const char* stream) {
    RandomStream random(3, stream);
    return noise_batch(spec_, 5, steps, Patterns::clips * Patterns::clip, random);
  }

  /// Path of a model with frozen embeddings after two updates.
  std::filesystem::path frozen_model() {
    Trainer trainer(runtime_, spec_, {}, 5, 4, patterns_.stream);
    trainer.freeze_objects(frozen());
    for (int i = 0; i < 2; ++i) trainer.update(batch(4, "training"));
    trainer.save(folder_ / "model", {}, true);
    trainer.save_checkpoint(folder_ / "checkpoint");
    return folder_ / "model";
  }

  std::span<const float> frames(int first, int count) const {
    const auto size = std::size_t(spec_.rows) * spec_.cols;
    return std::span(patterns_.stream).subspan(first * size, count * size);
  }

  ModelSpec spec_ = small_spec(ObjectEncoder::frozen);
  Patterns patterns_{spec_};
  double first_loss_ = 0.0, last_loss_ = 0.0;
};

TEST_F(ObjectEncoderTest, SeparatesObjects) {
  const auto encoder = trained_encoder(60);
  EXPECT_LT(last_loss_, 0.05 * first_loss_);
  RandomStream random(9, "unseen");
  const auto batch = patterns_.batch(spec_, 21, random);
  ObjectEmbedder embedder(runtime_, spec_, encoder);
  const auto e = embedder.embed(runtime_.upload<float>(patterns_.stream), batch.first_frame);
  const auto product = [&](int i, int j) {
    return std::inner_product(&e[i * spec_.embedding], &e[(i + 1) * spec_.embedding],
                              &e[j * spec_.embedding], 0.0);
  };
  for (int i = 0; i < 21; ++i) {
    int nearest = i == 0 ? 1 : 0;
    for (int j = 0; j < 21; ++j)
      if (j != i && product(i, j) > product(i, nearest)) nearest = j;
    EXPECT_EQ(batch.object[i], batch.object[nearest]);
  }
}

TEST_F(ObjectEncoderTest, TrainsReproducibly) {
  const auto a = trained_encoder(4), b = trained_encoder(4);
  for (std::size_t i = 0; i < a.tensors.size(); ++i) {
    EXPECT_TRUE(a.tensors[i].name.starts_with("object."));
    EXPECT_EQ(a.tensors[i].values, b.tensors[i].values);
  }
}

TEST_F(ObjectEncoderTest, RejectsSegmentsOutsideTheStream) {
  ObjectTrainer trainer(runtime_, spec_, {}, 2, patterns_.stream);
  EXPECT_THROW(trainer.update({{0, Patterns::clips * Patterns::clip - 3}, {0, 1}}), Error);
  EXPECT_THROW(trainer.update({{0, -1}, {0, 1}}), Error);
  EXPECT_THROW(trainer.update({{0}, {0}}), Error);
  EXPECT_NO_THROW(trainer.update({{0, 4}, {0, 1}}));
}

TEST_F(ObjectEncoderTest, EmbeddingDoesNotDependOnOtherSegments) {
  const auto encoder = trained_encoder(1);
  ObjectEmbedder embedder(runtime_, spec_, encoder);
  const auto stream = runtime_.upload<float>(patterns_.stream);
  std::vector<std::int32_t> first(37);
  std::iota(first.begin(), first.end(), 0);
  const auto together = embedder.embed(stream, first);
  for (int i : {0, 15, 16, 36}) {
    const auto alone = embedder.embed(stream, std::vector<std::int32_t>{i});
    EXPECT_TRUE(
        std::ranges::equal(alone, std::span(together).subspan(i * alone.size(), alone.size())));
  }
}

TEST(MeanEmbeddings, AveragesByObject) {
  const std::vector<float> e{1, 2, 3, 4, 5, 6};
  const std::vector<std::int32_t> object{1, 0, 1};
  EXPECT_EQ(mean_embeddings(e, object, 2), (std::vector<float>{3, 4, 3, 4}));
}

TEST_F(ObjectEncoderTest, SavesFrozenWeightsUnchanged) {
  const auto encoder = frozen().encoder;
  const auto model = read_safetensors(frozen_model()),
             checkpoint = read_safetensors(folder_ / "checkpoint");
  for (const auto& tensor : encoder) {
    EXPECT_EQ(model.at(tensor.name, tensor.values.size()).values, tensor.values);
    EXPECT_EQ(checkpoint.at(tensor.name, tensor.values.size()).values, tensor.values);
  }
}

TEST_F(ObjectEncoderTest, TrainingRequiresFrozenEmbeddings) {
  Trainer trainer(runtime_, spec_, {}, 5, 4, patterns_.stream);
  EXPECT_THROW(trainer.update(batch(4, "training")), Error);
  trainer.freeze_objects(frozen());
  auto unknown = batch(4, "training");
  unknown.object[2] = Patterns::objects;
  EXPECT_THROW(trainer.update(unknown), Error);
  EXPECT_NO_THROW(trainer.update(batch(4, "training")));
}

/// Batch of sequence `s` only.
RolloutBatch alone(const RolloutBatch& batch, int s, const ModelSpec& spec) {
  RolloutBatch one{1, batch.steps, {batch.first_frame[s]}, {}, {}, {}};
  const auto* state = &batch.initial_state[std::size_t(s) * spec.state];
  one.initial_state.assign(state, state + spec.state);
  one.segment_frame = {batch.segment_frame[s]};
  return one;
}

TEST_F(ObjectEncoderTest, PredictorUsesTheSegment) {
  Predictor predictor(runtime_, frozen_model());
  const auto given = batch(45, "prediction");
  const auto together = predictor.predict(given, patterns_.stream);
  for (int s = 0; s < given.sequences; ++s) {
    auto one = alone(given, s, spec_);
    const auto rollout = predictor.predict(one, patterns_.stream);
    const auto at = std::ptrdiff_t(s) * given.steps * spec_.state;
    EXPECT_TRUE(std::ranges::equal(rollout.state,
                                   std::span(together.state).subspan(at, rollout.state.size())));
    one.segment_frame[0] = (one.segment_frame[0] + Patterns::clip) % 200;  // of another object
    EXPECT_NE(predictor.predict(one, patterns_.stream).state, rollout.state);
    one.segment_frame.clear();
    EXPECT_THROW(predictor.predict(one, patterns_.stream), Error);
  }
}

TEST_F(ObjectEncoderTest, OnlinePredictorMatchesPredictor) {
  const auto model = frozen_model();
  const auto one = alone(batch(6, "online"), 0, spec_);
  const auto rollout = Predictor(runtime_, model).predict(one, patterns_.stream);
  OnlinePredictor online(runtime_, model);
  online.set_state(one.initial_state);
  for (int i = spec_.window_frames - 1; i > 0; --i) online.push(frames(one.first_frame[0] - i, 1));
  EXPECT_THROW(online.step(frames(one.first_frame[0], 1)), Error) << "no object set";
  // The rejected step has not appended its frame.
  online.set_object(frames(one.segment_frame[0], spec_.segment_frames));
  for (int t = 0; t < one.steps; ++t) {
    const auto step = online.step(frames(one.first_frame[0] + t, 1));
    for (int i = 0; i < spec_.state; ++i)
      EXPECT_EQ(step.state[i], rollout.state[std::size_t(t) * spec_.state + i]) << t;
  }
}

TEST_F(ObjectEncoderTest, OnlinePredictorTakesAnEmbeddingInsteadOfASegment) {
  const auto model = frozen_model();
  const std::int32_t first = 20;
  const auto embedding = ObjectEmbedder(runtime_, spec_, read_safetensors(model))
                             .embed(runtime_.upload<float>(patterns_.stream), std::span(&first, 1));
  OnlinePredictor by_segment(runtime_, model), by_embedding(runtime_, model);
  by_segment.set_object(frames(first, spec_.segment_frames));
  by_embedding.set_object_embedding(embedding);
  for (int frame = 40; frame < 43; ++frame)
    EXPECT_TRUE(std::ranges::equal(by_segment.step(frames(frame, 1)).state,
                                   by_embedding.step(frames(frame, 1)).state));
  by_embedding.set_object_embedding(std::vector<float>(embedding.size(), 1.0f));
  EXPECT_FALSE(std::ranges::equal(by_segment.step(frames(43, 1)).state,
                                  by_embedding.step(frames(43, 1)).state));
  EXPECT_THROW(by_embedding.set_object_embedding({}), Error);
}

}  // namespace
}  // namespace touchtrace
