// Training and evaluation on a synthetic problem in which only touch shows the force.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "engine/train/object_embedder.h"
#include "engine/train/predictor.h"
#include "pipeline/study/evaluation.h"
#include "pipeline/study/object_training.h"
#include "pipeline/study/training.h"
#include "tests/support/scratch.h"
#include "tests/verify/study/synthetic.h"

namespace {

namespace fs = std::filesystem;
using namespace touchtrace;
using namespace touchtrace::study;

class Learning : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { runtime_ = std::make_unique<Runtime>(choose_device("")); }
  static void TearDownTestSuite() { runtime_.reset(); }

  void SetUp() override {
    folder_ = touchtrace::testing::scratch_folder();
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  TrainingOptions options(const std::string& name, int updates) const {
    TrainingOptions o;
    o.output = (folder_ / name).string();
    o.model.window = 4;
    o.optimizer.updates = updates;
    return o;
  }

  static ModelCard train(const Dataset& data, const TrainingOptions& options) {
    Provenance provenance = start_provenance("touchtrace/model/1", "train");
    provenance.options = {{"updates", options.optimizer.updates}};
    return train_model(*runtime_, data, options, std::move(provenance), true);
  }

  /// Weights of a model file: the bytes after its header.
  static std::string weights(const std::string& path) {
    const std::string bytes = read_file(path);
    std::uint64_t header = 0;
    for (int i = 7; i >= 0; --i)
      header = header << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
    return bytes.substr(8 + header);
  }

  static std::vector<LoadedModel> load(const std::vector<std::string>& paths) {
    std::vector<LoadedModel> models;
    for (const auto& path : paths) models.push_back(load_model(*runtime_, path));
    return models;
  }

  /// Interrupts a run once it has a checkpoint, resumes it and compares with an uninterrupted run.
  void expect_bit_identical_resume(const Dataset& data, TrainingOptions broken,
                                   const TrainingOptions& whole) {
    EXPECT_EXIT(
        {
          catch_interrupts();
          const std::jthread user([&] {
            while (!fs::exists(broken.output + ".checkpoint")) std::this_thread::yield();
            std::raise(SIGINT);
          });
          try {
            train(data, broken);
          } catch (const Error& error) {
            std::_Exit(static_cast<int>(error.code()));
          }
        },
        ::testing::ExitedWithCode(130), "");
    EXPECT_FALSE(fs::exists(broken.output));
    ASSERT_TRUE(fs::exists(broken.output + ".checkpoint"));
    broken.resume = true;
    train(data, broken);
    train(data, whole);
    EXPECT_EQ(weights(broken.output), weights(whole.output));
    EXPECT_FALSE(fs::exists(broken.output + ".checkpoint"));
  }

  static std::unique_ptr<Runtime> runtime_;
  fs::path folder_;
};

std::unique_ptr<Runtime> Learning::runtime_;

TEST_F(Learning, FullIsBetterThanWithoutTouchIsBetterThanRandom) {
  const Dataset data = synthetic_dataset({40});
  auto full = options("full", 400), without = options("without", 400);
  without.model.without_touch = true;
  train(data, full);
  const ModelCard card = train(data, without);
  EXPECT_EQ(card.name(), "without_touch");
  for (const auto& entry : card.log)
    if (entry.update == card.update) {
      for (const auto& other : card.log)
        EXPECT_LE(entry.validation_l1_at_50, other.validation_l1_at_50) << other.update;
    }
  EXPECT_EQ(card.objects, std::vector<std::string>{"ball"});

  std::vector<Session> sessions{{"synthetic", data, {}}};
  auto models = load({full.output, without.output});
  const auto document = evaluate_models(sessions, models, {});
  EXPECT_EQ(document.at("against"), "truth");
  std::map<std::string, nlohmann::json> row;
  for (const auto& result : document.at("results")) row[result.at("model")] = result;
  for (const char* metric : {"l1_at_20", "l1_at_50"}) {
    const double best = row["full"].at(metric), middle = row["without_touch"].at(metric),
                 worst = row["random"].at(metric);
    EXPECT_LT(best, 0.8 * middle) << metric;
    EXPECT_LT(middle, worst) << metric;
  }
  // 10 evaluation and 3 calibration clips; the force is correlated over (1 + .8) / (1 - .8) = 9 of
  // 120 frames, 3 axes: 390 and 117 independent values. Standard error of coverage with fitted
  // scale: sqrt(.8 .2 (1 / 390 + 1 / 117)) = 4.2 %; 3 of these.
  EXPECT_NEAR(row["full"].at("coverage").get<double>(), 0.8, 0.127);
  EXPECT_EQ(row["full"].at("split"), "seen");
  for (const auto& difference : document.at("differences"))
    for (const char* metric : {"l1_at_20", "l1_at_50", "object_error_m_per_s_at_50"})
      EXPECT_LT(difference.at("metrics").at(metric).at("high").get<double>(), 0.0) << difference;
  EXPECT_EQ(document.at("examples").size(), 3u);
  EXPECT_EQ(document.at("curves")[1].at("l1_by_step").size(), 50u);
}

TEST_F(Learning, EvaluationClipsDoNotReachTheWeights) {
  const Dataset clean = synthetic_dataset();
  Dataset poisoned = clean;
  for (const auto& sequence : poisoned.sequences)
    for (int f = sequence.first_frame;
         sequence.split == Split::evaluation && f < sequence.first_frame + sequence.frames; ++f) {
      poisoned.label[f].fill(1e6f);
      poisoned.causal_label[f].fill(-1e6f);
      for (int i = 0; i < poisoned.rows * poisoned.cols; ++i)
        poisoned.tactile[static_cast<std::size_t>(f * poisoned.rows * poisoned.cols + i)] = 1.0f;
    }
  poisoned.truth.assign(poisoned.truth.size(), State{});
  const ModelCard a = train(clean, options("clean", 25)),
                  b = train(poisoned, options("poisoned", 25));
  EXPECT_EQ(weights(options("clean", 25).output), weights(options("poisoned", 25).output));
  EXPECT_EQ(a.scaling.sigma, b.scaling.sigma);
  EXPECT_EQ(a.band_scale, b.band_scale);
}

/// The card's embedding is the mean of those of the objects, and is read back from the file.
void expect_mean_embedding(const Dataset& data, const ModelCard& card, const std::string& path) {
  Runtime runtime(choose_device(""));
  const Predictor model(runtime, path);
  EXPECT_EQ(read_card(model.metadata(), path).mean_embedding, card.mean_embedding);
  const bool has_encoder = card.spec.object != ObjectEncoder::none;
  const auto size = static_cast<std::size_t>(has_encoder ? card.spec.embedding : 0);
  ASSERT_EQ(card.mean_embedding.size(), size);
  if (!has_encoder) return;
  const auto of_objects =
      freeze_objects(runtime, data, card.spec, object_encoder_of(read_safetensors(path))).embedding;
  ASSERT_EQ(of_objects.size(), 3 * size);
  for (std::size_t i = 0; i < size; ++i) {
    const double sum =
        double{of_objects[i]} + double{of_objects[size + i]} + double{of_objects[2 * size + i]};
    EXPECT_FLOAT_EQ(card.mean_embedding[i], static_cast<float>(sum / 3.0));
  }
}

SyntheticOptions three_objects() {
  SyntheticOptions o;
  o.clips = 30, o.objects = 3;
  return o;
}

TEST_F(Learning, ObjectEncoderIsUsedForSeveralObjects) {
  const Dataset data = synthetic_dataset(three_objects());
  std::vector<std::string> files;
  for (const char* encoder : {"auto", "joint", "none"}) {
    auto o = options(encoder, 60);
    o.model.object_encoder = encoder;
    o.objects.updates = 30;
    const ModelCard card = train(data, o);
    EXPECT_EQ(card.objects.size(), 3u);
    EXPECT_EQ(card.name(), o.model.object_encoder == "none" ? "without_embedding" : "full");
    EXPECT_EQ(card.spec.object, o.model.object_encoder == "joint"  ? ObjectEncoder::joint
                                : o.model.object_encoder == "none" ? ObjectEncoder::none
                                                                   : ObjectEncoder::frozen);
    EXPECT_EQ(read_safetensors(o.output).tensors.size(),
              o.model.object_encoder == "none" ? 16u : 26u);
    expect_mean_embedding(data, card, o.output);
    files.push_back(o.output);
  }
  for (const auto& full : {files[0], files[1]}) {
    auto models = load({full, files[2]});
    const std::vector<Session> sessions{{"synthetic", data, {}}};
    const auto document = evaluate_models(sessions, models, {});
    std::map<std::string, int> rows, differences;
    for (const auto& result : document.at("results")) ++rows[result.at("model")];
    for (const auto& difference : document.at("differences")) ++differences[difference.at("other")];
    for (const char* model : {"random", "hold", "linear", "full", "without_embedding"})
      EXPECT_EQ(rows[model], 4) << model << ": three objects and all of them";
    EXPECT_EQ(differences, (std::map<std::string, int>{
                               {"without_embedding", 4}, {"hold", 4}, {"other_touch", 4}}));
  }
}

TEST_F(Learning, OneObjectHasNoEncoder) {
  const Dataset data = synthetic_dataset();
  const auto plain = options("plain", 2);
  train(data, plain);
  for (const char* encoder : {"frozen", "joint"}) {
    auto o = options(encoder, 2);
    o.model.object_encoder = encoder;
    EXPECT_EQ(train(data, o).spec.object, ObjectEncoder::none);
    EXPECT_EQ(weights(o.output), weights(plain.output));
  }
}

TEST(ModelCard, SavedEntryIsThatOfTheSavedWeights) {
  ModelCard card;
  EXPECT_EQ(card.saved_entry(), nullptr);
  card.log = {
      {10, 0.0, 0.0, 0.0, 0.5, 0.6}, {20, 0.0, 0.0, 0.0, 0.3, 0.4}, {30, 0, 0, 0, 0.7, 0.8}};
  card.update = 20;
  ASSERT_NE(card.saved_entry(), nullptr);
  EXPECT_EQ(card.saved_entry()->validation_l1_at_20, 0.3);
}

TEST(SegmentSampler, SegmentsAreInsideTrainingClipsOfTheirObject) {
  const Dataset data = synthetic_dataset(three_objects());
  const auto names = training_objects(data);
  const SegmentSampler sampler(data, 20, 12, 1);
  const auto clip_of = [&](int frame) {
    return *std::ranges::find_if(data.sequences, [&](const Sequence& s) {
      return frame >= s.first_frame && frame < s.first_frame + s.frames;
    });
  };
  for (const auto& batch : {sampler.batch(0), sampler.batch(7), sampler.all(10)})
    for (std::size_t i = 0; i < batch.object.size(); ++i) {
      const Sequence clip = clip_of(batch.first_frame[i]);
      EXPECT_EQ(clip.split, Split::train);
      EXPECT_EQ(clip.object, names[static_cast<std::size_t>(batch.object[i])]);
      EXPECT_LE(batch.first_frame[i] + 20, clip.first_frame + clip.frames);
    }
  EXPECT_EQ(sampler.batch(3).first_frame, sampler.batch(3).first_frame);
  EXPECT_NE(sampler.batch(3).first_frame, sampler.batch(4).first_frame);
  EXPECT_THROW(SegmentSampler(data, 121, 12, 1), Error);
}

TEST(RolloutCases, StartAfterTheSegmentThatIdentifiesTheObject) {
  const Dataset data = synthetic_dataset(three_objects());
  ModelSpec spec;
  EXPECT_EQ(required_history(spec), spec.window_frames);
  spec.object = ObjectEncoder::frozen;
  EXPECT_EQ(required_history(spec), spec.segment_frames);
  const auto cases =
      make_cases(data, {Split::evaluation, 50, 5, required_history(spec)}, {}, Reference::labels);
  for (int i = 0; i < cases.count(); ++i) {
    EXPECT_EQ(cases.batch.segment_frame[i], data.sequences[cases.sequence[i]].first_frame);
    EXPECT_LT(cases.batch.segment_frame[i] + spec.segment_frames, cases.batch.first_frame[i] + 2);
  }
}

using LearningDeathTest = Learning;

TEST_F(LearningDeathTest, ResumedRunIsBitIdentical) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto broken = options("broken", 60);
  broken.checkpoint_s = 0.0;
  expect_bit_identical_resume(synthetic_dataset(), broken, options("whole", 60));
}

TEST_F(LearningDeathTest, ResumedRunWithFrozenObjectsIsBitIdentical) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto broken = options("broken", 60), whole = options("whole", 60);
  broken.checkpoint_s = 0.0;
  broken.objects.updates = whole.objects.updates = 4;
  expect_bit_identical_resume(synthetic_dataset(three_objects()), broken, whole);
}

TEST_F(Learning, DoesNotOverwriteAnExistingModel) {
  const Dataset data = synthetic_dataset();
  const auto o = options("model", 1);
  write_file(o.output, "something", false);
  EXPECT_THROW(train_model(*runtime_, data, o, start_provenance("", ""), false), Error);
  EXPECT_EQ(read_file(o.output), "something");
}

// The failure itself saves the checkpoint.
TEST_F(Learning, ATrainingThatFailedResumesWithSkippedUpdates) {
  const Dataset data = synthetic_dataset();
  auto o = options("model", 60);
  o.optimizer.learning_rate = 1e30;
  const auto error_of = [&](int skips) -> std::string {
    o.optimizer.max_consecutive_skips = skips;
    auto provenance = start_provenance("train", "");
    provenance.options = {{"updates", 60}, {"skip_not_finite", skips}};
    try {
      train_model(*runtime_, data, o, provenance, false);
    } catch (const Error& error) {
      return fmt::format("{}; {}", error.what(), error.hint());
    }
    return {};
  };
  const auto failed = error_of(0);
  EXPECT_NE(failed.find("not finite"), failed.npos) << failed;
  EXPECT_NE(failed.find("--resume continues from the checkpoint"), failed.npos) << failed;
  o.resume = true;
  const auto resumed = error_of(2);
  EXPECT_NE(resumed.find("not finite"), resumed.npos) << resumed;
}

TEST_F(Learning, RejectsResumingWithoutACheckpoint) {
  auto o = options("none", 1);
  o.resume = true;
  EXPECT_THROW(train(synthetic_dataset(), o), Error);
}

TEST_F(Learning, RejectsClipsThatAreTooShort) {
  EXPECT_THROW(train(synthetic_dataset({4, 12}), options("short", 1)), Error);
}

TEST_F(Learning, RejectsAModelOfAnotherActivity) {
  Dataset data = synthetic_dataset();
  train(data, options("model", 1));
  data.activity = "throw";
  std::vector<Session> sessions{{"throw", data, {}}};
  auto models = load({options("model", 1).output});
  EXPECT_THROW(evaluate_models(sessions, models, {}), Error);
}

}  // namespace
