// Evaluation cannot mislead: each model gets its own input, seeds are kept apart, no clip is seen
// by a model, and what is compared is said.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/base/file_lock.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/study/evaluation.h"
#include "pipeline/study/training.h"
#include "pipeline/study/truth.h"
#include "tests/support/scratch.h"
#include "tests/verify/study/synthetic.h"

namespace {

namespace fs = std::filesystem;
using namespace touchtrace;
using namespace touchtrace::study;
using nlohmann::json;

class Evaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { runtime_ = std::make_unique<Runtime>(choose_device("")); }
  static void TearDownTestSuite() { runtime_.reset(); }
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  /// Trains for a few updates; returns the model's file.
  std::string train(const Dataset& data, const std::string& name, std::uint64_t seed = 1,
                    bool touch = true) const {
    TrainingOptions o;
    o.output = (folder_ / name).string();
    o.model.window = 4;
    o.model.without_touch = !touch;
    o.optimizer.updates = 3;
    o.optimizer.seed = seed;
    Provenance provenance = start_provenance("touchtrace/model/1", "train");
    provenance.options = {{"resolution", data.rows}, {"seed", seed}, {"output", name}};
    provenance.seed = seed;
    train_model(*runtime_, data, o, std::move(provenance), true);
    return o.output;
  }

  json evaluate(const std::vector<Session>& sessions, const std::vector<std::string>& paths,
                const EvaluationOptions& options = {}) const {
    std::vector<LoadedModel> models;
    for (const auto& path : paths) models.push_back(load_model(*runtime_, path));
    return evaluate_models(sessions, models, options);
  }

  static json row(const json& document, const std::string& model) {
    for (const auto& found : document.at("results"))
      if (found.at("model") == model) return found;
    ADD_FAILURE() << "no row of " << model;
    return {};
  }

  static std::unique_ptr<Runtime> runtime_;
  fs::path folder_ = touchtrace::testing::scratch_folder();
};

std::unique_ptr<Runtime> Evaluation::runtime_;

/// The data set with images averaged to `size` x `size`.
Dataset coarser(Dataset data, int size) {
  const AreaAverage average(data.rows, data.cols, size, size);
  std::vector<float> images;
  for (int frame = 0; frame < data.frames(); ++frame) {
    std::vector<float> image(static_cast<std::size_t>(size * size));
    average.apply(std::span(data.tactile)
                      .subspan(static_cast<std::size_t>(frame * data.rows * data.cols),
                               static_cast<std::size_t>(data.rows * data.cols)),
                  image);
    images.insert(images.end(), image.begin(), image.end());
  }
  data.tactile = std::move(images);
  data.rows = data.cols = size;
  return data;
}

TEST_F(Evaluation, EachModelGetsImagesOfItsResolution) {
  const Dataset fine = synthetic_dataset(), coarse = coarser(fine, 6);
  const auto a = train(fine, "fine"), b = train(coarse, "coarse");
  const json both = evaluate({{"s", fine, {}}}, {a, b}), alone = evaluate({{"s", coarse, {}}}, {b});
  EXPECT_EQ(row(both, "full resolution=6").at("l1_at_50"), row(alone, "full").at("l1_at_50"));
  EXPECT_NE(row(both, "full resolution=8").at("l1_at_50"), row(alone, "full").at("l1_at_50"));
  EXPECT_THROW(evaluate({{"s", coarse, {}}}, {a}), Error) << "fewer taxels than the model";
}

TEST_F(Evaluation, SeedsOfOneModelAreOneRow) {
  const Dataset data = synthetic_dataset();
  const std::vector<std::string> files{train(data, "a", 1), train(data, "b", 2),
                                       train(data, "c", 1, false)};
  const json document = evaluate({{"s", data, {}}}, files);
  EXPECT_EQ(row(document, "full").at("runs"), 2);
  EXPECT_EQ(row(document, "without_touch").at("runs"), 1);
  EXPECT_EQ(row(document, "hold").at("runs"), 0);
  std::vector<double> values;
  for (const auto& run : document.at("runs"))
    if (run.at("model") == "full") {
      EXPECT_EQ(run.at("file"), files[values.size()]);
      values.push_back(run.at("l1_at_50"));
    }
  ASSERT_EQ(values.size(), 2u);
  EXPECT_NE(values[0], values[1]);
  EXPECT_NEAR(row(document, "full").at("l1_at_50").get<double>(), (values[0] + values[1]) / 2,
              1e-9);
}

TEST_F(Evaluation, OneTrainingIsNotTwoSeeds) {
  const Dataset data = synthetic_dataset();
  EXPECT_THROW(evaluate({{"s", data, {}}}, {train(data, "a"), train(data, "resumed")}), Error);
}

TEST_F(Evaluation, TheTouchOfOtherRolloutsIsTheControl) {
  const Dataset data = synthetic_dataset();
  const json document =
      evaluate({{"s", data, {}}}, {train(data, "full"), train(data, "blind", 1, false)});
  EXPECT_EQ(row(document, "other_touch").at("runs"), 1);
  EXPECT_NE(row(document, "other_touch").at("l1_at_50"), row(document, "full").at("l1_at_50"));
  std::set<std::string> others;
  for (const auto& difference : document.at("differences")) others.insert(difference.at("other"));
  EXPECT_EQ(others, (std::set<std::string>{"hold", "other_touch", "without_touch"}));
  Dataset untouched = data;
  std::ranges::fill(untouched.tactile, 0.0f);
  const json without = evaluate({{"s", untouched, {}}}, {train(untouched, "untouched")});
  EXPECT_EQ(row(without, "other_touch").at("l1_at_50"), row(without, "full").at("l1_at_50"));
}

TEST_F(Evaluation, DifferencesOfTrainingAndUnitsAreNoted) {
  const Dataset fine = synthetic_dataset(), coarse = coarser(fine, 6);
  Dataset millimetres = fine;
  for (State& state : millimetres.label)
    for (float& value : state) value *= 1e3f;
  const auto full = train(fine, "full"), blind = train(coarse, "blind", 1, false);
  EvaluationOptions options;
  options.against = "labels";
  const auto notes = [&](const Dataset& data, const std::vector<std::string>& models) {
    return evaluate({{"s", data, {}}}, models, options).at("notes").dump();
  };
  EXPECT_NE(notes(fine, {full, blind}).find("resolution 8 and 6"), std::string::npos);
  EXPECT_EQ(notes(fine, {full}).find("times as far"), std::string::npos);
  EXPECT_NE(notes(millimetres, {full}).find("times as far"), std::string::npos);
}

TEST_F(Evaluation, UntrustedLabelsReachNoMetric) {
  const Dataset clean = synthetic_dataset();
  const auto model = train(clean, "model");
  const auto with_lost = [&](float value) {
    Dataset data = clean;
    data.truth.clear();
    for (int f = 0; f < data.frames(); f += 9) data.trusted[f] = 0, data.label[f].fill(value);
    json document = evaluate({{"s", data, {}}}, {model});
    for (const char* key : {"examples", "models"}) document.erase(key);
    return document;
  };
  EXPECT_EQ(with_lost(0.0f).dump(), with_lost(1e3f).dump());
}

TEST_F(Evaluation, UnseenRecordingIsUsedWhole) {
  const Dataset seen = synthetic_dataset(), unseen = synthetic_dataset({.seed = 2});
  const auto model = train(seen, "model");
  const json known = evaluate({{"s", seen, {}}}, {model}),
             whole = evaluate({{"u", unseen, {}}}, {model});
  EXPECT_EQ(row(known, "full").at("clips"), 5);
  EXPECT_EQ(row(whole, "full").at("clips"), 20);
  EXPECT_NE(whole.at("notes").dump().find("u"), std::string::npos);
  for (const auto& result : whole.at("results")) EXPECT_NE(result.at("model"), "linear");
}

TEST_F(Evaluation, RefusesAModelThatHasSeenAnEvaluationClip) {
  const Dataset data = synthetic_dataset();
  const auto model = train(data, "model");
  for (const int clip : {0, 12, 13}) {  // training, validation, calibration
    Dataset leaking = data;
    leaking.sequences[static_cast<std::size_t>(clip)].split = Split::evaluation;
    EXPECT_THROW(evaluate({{"s", leaking, {}}}, {model}), Error) << clip;
  }
}

TEST_F(Evaluation, RefusesAnotherRate) {
  Dataset data = synthetic_dataset();
  const auto model = train(data, "model");
  data.rate_hz = 30.0;
  EXPECT_THROW(evaluate({{"s", data, {}}}, {model}), Error);
}

TEST_F(Evaluation, ReportsMetresWithoutTheShiftOfTheTruth) {
  Dataset data = synthetic_dataset();
  for (State& label : data.label) label[0] += 3.0f;
  data.causal_label = data.label;
  const auto model = train(data, "model");
  shift_truth(data, estimate_truth_offset(data));
  const json hold = row(evaluate({{"s", data, {}}}, {model}), "hold");
  const auto error = [](const json& metrics) {
    return metrics.at("object_error_m_at_50").get<double>();
  };
  EXPECT_NEAR(error(hold), error(hold.at("against_labels")), 1e-6);
  EXPECT_GT(error(hold.at("against_unshifted_truth")), error(hold) + 1.0);
}

TEST_F(Evaluation, ModelsOfOtherObjectsAreNamed) {
  const Dataset one = synthetic_dataset(), three = synthetic_dataset({.clips = 30, .objects = 3});
  const auto a = train(one, "one", 1), b = train(three, "three", 2);
  const json document = evaluate({{"u", synthetic_dataset({.seed = 3}), {}}}, {a, b});
  EXPECT_NE(document.at("notes").dump().find("other objects"), std::string::npos);
}

TEST_F(Evaluation, TwoTrainingsCannotShareAnOutput) {
  const FileLock lock(folder_ / "model");
  EXPECT_THROW(train(synthetic_dataset(), "model"), Error);
}

TEST(FileLock, IsReleasedAndLeavesNoFile) {
  const auto path = touchtrace::testing::scratch_folder() / "output";
  { const FileLock lock(path); }
  EXPECT_FALSE(fs::exists(path.string() + ".lock"));
  EXPECT_NO_THROW(FileLock{path});
  fs::remove_all(path.parent_path());
}

TEST(TruthOffset, RemovesAConstantDifference) {
  Dataset data = synthetic_dataset();
  for (State& state : data.label) {
    state[1] += 0.02f;
    state[8] -= 0.05f;
  }
  const State offset = estimate_truth_offset(data);
  EXPECT_NEAR(offset[1], 0.02, 1e-6);
  EXPECT_NEAR(offset[8], -0.05, 1e-6);
  shift_truth(data, offset);
  for (int f = 0; f < data.frames(); f += 100)
    for (int d = 0; d < state_size; ++d) EXPECT_NEAR(data.truth[f][d], data.label[f][d], 1e-6);
}

}  // namespace
