#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/check/operation_check.h"
#include "engine/check/rows.h"
#include "engine/cl/launch_inspection.h"
#include "engine/ops/conv2d_candidates.h"
#include "engine/ops/conv2d_methods.h"
#include "engine/train/encoder_trials.h"
#include "engine/train/layer_trials.h"
#include "engine/train/tuner.h"
#include "engine/train/tuning_file.h"
#include "engine/train/tuning_json.h"
#include "tests/engine/trainer_fixture.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::NoiseRun;
using testing::small_spec;
using testing::TrainerTest;

const Conv2dShape planes{3, 10, 16, 16, 32, true}, blocks{5, 32, 16, 16, 64, false};

/// Configurations for NoiseRun's encoder that differ from the default in every number.
Tuning odd_tuning() {
  Tuning tuning;
  const ConvStackShape encoder{{12, 3, 9, 6}};
  tuning.set(Tuning::MicroBatch{encoder.layers()[0], 5});
  for (const auto& layer : encoder.of_windows(5).layers())
    tuning.set(Tuning::Layer{layer, {Conv2dMethod::winograd, 12, 2, 3, 1, 3}, {1.5, 1.25}});
  return tuning;
}

TEST(Conv2dCandidates, MatchReference) {
  Runtime runtime(choose_device(""));
  if (runtime.kernel_variant() == KernelVariant::gpu)
    GTEST_SKIP() << "GPU kernels have no candidates";
  for (const auto& shape : {planes, blocks}) {
    const auto [products, gradients] = conv2d_candidates(runtime, shape);
    EXPECT_GE(products.size(), 3u);
    EXPECT_LE(products.size() + gradients.size(), 10u);
    auto choices = products;
    for (const auto& gradient : gradients) choices.push_back(joined(products.back(), gradient));
    for (const auto& choice : choices) {
      SCOPED_TRACE(describe(choice));
      const auto operation = conv2d_case(shape, choice);
      const auto inputs = draw_inputs(operation, 1, gradient_kink_margin);
      EXPECT_LE(output_error(runtime, operation, inputs), output_error_bound);
      EXPECT_LE(gradient_error(runtime, operation, inputs, 1), gradient_error_bound);
    }
  }
}

TEST(LayerTrials, AcceptBothMethods) {
  Runtime runtime(choose_device(""));
  LayerTrials trials(runtime, blocks, 2);
  EXPECT_TRUE(trials.make({Conv2dMethod::direct}));
  EXPECT_TRUE(trials.make({Conv2dMethod::winograd}));
}

TEST(LayerTrials, RejectDifferentResults) {
  const LayerResults good{{1, -2, 3}, {4, 5}, {6, 7, 8}};
  const auto with = [&](auto change) {
    auto results = good;
    change(results);
    return agree(blocks, results, good);
  };
  EXPECT_TRUE(with([](LayerResults&) {}));
  EXPECT_TRUE(with([](LayerResults& r) { r.out[0] += 1e-6; }));
  EXPECT_FALSE(with([](LayerResults& r) { r.out[0] += 1e-3; }));
  EXPECT_FALSE(with([](LayerResults& r) { r.grad_in[1] += 1e-2; }));
  EXPECT_FALSE(with([](LayerResults& r) { r.gradient[2] = NAN; }));
  EXPECT_FALSE(with([](LayerResults& r) { r.gradient.pop_back(); }));
}

TEST(Tuning, FallsBackToTheNearestNumberOfImages) {
  Tuning tuning;
  const auto of = [](int images) {
    auto shape = blocks;
    shape.images = images;
    return shape;
  };
  EXPECT_EQ(tuning.layer(blocks), nullptr);
  tuning.set(Tuning::Layer{of(32), {Conv2dMethod::winograd}});
  tuning.set(Tuning::Layer{of(20), {Conv2dMethod::direct, 12}});
  EXPECT_EQ(tuning.layer(of(20))->choice.accumulators, 12);
  EXPECT_EQ(tuning.layer(of(28))->shape.images, 32);
  EXPECT_EQ(tuning.layer(of(10))->shape.images, 20);
  EXPECT_EQ(tuning.layer(of(9)), nullptr) << "methods pay from some number of images on";
  EXPECT_EQ(tuning.layer(planes), nullptr);
  tuning.set(Tuning::Layer{of(32), {}});
  EXPECT_EQ(tuning.layers.size(), 2u);
  EXPECT_EQ(tuning.layer(of(32))->choice.method, Conv2dMethod::direct);
  tuning.set(Tuning::MicroBatch{of(160), 40});
  EXPECT_EQ(tuning.micro_batch(of(640))->images, 40);
}

class TuningFile : public TrainerTest {
 protected:
  std::filesystem::path path_ = folder_ / "touchtrace" / "tuning.json";
  DeviceInfo device_ = runtime_.device();

  json document() { return json::parse(read_file(path_)); }
  /// The tuning and whether reading it warned.
  std::pair<Tuning, bool> read() {
    ::testing::internal::CaptureStderr();
    auto tuning = read_tuning(path_, device_);
    return {std::move(tuning), !::testing::internal::GetCapturedStderr().empty()};
  }
  void expect_ignored() {
    const auto [tuning, warned] = read();
    EXPECT_TRUE(tuning.layers.empty() && tuning.micro_batches.empty());
    EXPECT_TRUE(warned);
  }
};

TEST_F(TuningFile, KeepsTheTuningOfEachDevice) {
  EXPECT_TRUE(read_tuning(path_, device_).layers.empty());
  write_tuning(path_, device_, odd_tuning());
  auto other = device_;
  other.name = "another device";
  write_tuning(path_, other, {});
  const auto [tuning, warned] = read();
  EXPECT_EQ(json(tuning), json(odd_tuning()));
  EXPECT_FALSE(warned);
  EXPECT_EQ(tuning.layers.at(1).choice, odd_tuning().layers.at(1).choice);
  write_tuning(path_, device_, {});
  EXPECT_EQ(document().at("devices").size(), 2u);
  EXPECT_TRUE(read().first.layers.empty());
}

TEST_F(TuningFile, IgnoresStaleForeignAndDamagedFiles) {
  write_tuning(path_, device_, odd_tuning());
  const auto good = document();
  const auto changed = [&](auto change) {
    auto bad = good;
    change(bad);
    write_file(path_, bad.dump(), true);
    expect_ignored();
  };
  changed([](json& d) { d["devices"][0]["driver"] = "another"; });
  changed([](json& d) { d["devices"][0]["kernels"] = "other"; });
  changed([](json& d) { d["format"] = "touchtrace/tuning/99"; });
  changed([](json& d) { d = json::array(); });
  changed([](json& d) { d["devices"] = 3; });
  changed([](json& d) { d["devices"][0] = "no section"; });
  changed([](json& d) { d["devices"][0].erase("layers"); });
  changed([](json& d) { d["devices"][0]["layers"][0]["images"] = -1; });
  changed([](json& d) { d["devices"][0]["layers"][0]["group_images"] = 1e9; });
  changed([](json& d) { d["devices"][0]["layers"][0]["method"] = "magic"; });
  changed([](json& d) { d["devices"][0]["micro_batches"][0]["micro_batch_images"] = "many"; });
  const auto text = good.dump();
  for (const std::size_t length : {std::size_t(0), text.size() / 2, text.size() - 1}) {
    write_file(path_, text.substr(0, length), true);
    expect_ignored();
  }
  write_tuning(path_, device_, odd_tuning());
  EXPECT_EQ(document(), good) << "a damaged file is replaced";
}

TEST_F(TuningFile, IsInTheCacheFolder) {
  const char *cache_before = std::getenv("XDG_CACHE_HOME"), *home_before = std::getenv("HOME");
  const std::string cache_value = cache_before ? cache_before : "", home_value = home_before;
  const auto with = [](const char* cache, const char* home) {
    cache ? setenv("XDG_CACHE_HOME", cache, 1) : unsetenv("XDG_CACHE_HOME");
    home ? setenv("HOME", home, 1) : unsetenv("HOME");
    return tuning_path();
  };
  EXPECT_EQ(with("/a/cache", "/b"), "/a/cache/touchtrace/tuning.json");
  EXPECT_EQ(with(nullptr, "/b"), "/b/.cache/touchtrace/tuning.json");
  EXPECT_EQ(with("relative", "/b"), "/b/.cache/touchtrace/tuning.json");
  EXPECT_EQ(with("", nullptr), "");
  with(cache_before ? cache_value.c_str() : nullptr, home_value.c_str());
  EXPECT_TRUE(read_tuning("", device_).layers.empty());
}

TEST_F(TrainerTest, ResumesWithTheTuningOfTheCheckpoint) {
  if (runtime_.kernel_variant() == KernelVariant::gpu) GTEST_SKIP() << "GPU kernels are not tuned";
  const auto spec = small_spec(true);
  NoiseRun untuned(runtime_, spec), whole(runtime_, spec, odd_tuning()),
      again(runtime_, spec, odd_tuning());
  for (auto* run : {&untuned, &whole, &again}) run->train_until(8);
  const auto expected = whole.weights(folder_ / "whole");
  EXPECT_EQ(again.weights(folder_ / "again"), expected);
  EXPECT_TRUE(untuned.weights(folder_ / "untuned") != expected) << "the tuning is not used";

  NoiseRun killed(runtime_, spec, odd_tuning());
  killed.train_until(3);
  killed.trainer.save_checkpoint(folder_ / "checkpoint");
  NoiseRun tuned_again(runtime_, spec);
  EXPECT_THROW(tuned_again.trainer.load_checkpoint(folder_ / "checkpoint"), Error);
  NoiseRun resumed(runtime_, spec, Trainer::checkpoint_tuning(folder_ / "checkpoint"));
  resumed.trainer.load_checkpoint(folder_ / "checkpoint");
  resumed.train_until(8);
  EXPECT_EQ(resumed.weights(folder_ / "resumed"), expected);
}

TEST_F(TrainerTest, AcceptsNumbersBeyondDeviceAndImages) {
  auto tuning = odd_tuning();
  for (auto& layer : tuning.layers)
    layer.choice = {Conv2dMethod::winograd, 1 << 20, 1 << 20, 1 << 20, 1 << 10, 1 << 20};
  NoiseRun run(runtime_, small_spec(true), tuning), untuned(runtime_, small_spec(true));
  const auto batch = run.batch();
  EXPECT_NEAR(run.trainer.update(batch), untuned.trainer.update(batch), 1e-5);
}

/// The encoder of NoiseRun with more windows than a micro-batch.
const std::vector<ConvStackShape> small_encoders{{{40, 3, 9, 6}}};

TEST_F(TrainerTest, ResumesTuning) {
  Tuning tuning;
  int kept = 0;
  const auto stop_at_two = [&] {
    if (++kept == 2) throw Error(ExitCode::interrupted, "stopped", "");
  };
  EXPECT_THROW(tune(runtime_, small_encoders, tuning, stop_at_two), Error);
  ASSERT_EQ(tuning.layers.size(), 2u);
  const auto before = json(tuning).at("layers");
  EXPECT_FALSE(is_complete(tuning, small_encoders));
  tune(runtime_, small_encoders, tuning, [&] { ++kept; });
  EXPECT_TRUE(is_complete(tuning, small_encoders));
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(json(tuning).at("layers").at(i), before.at(i)) << "tuned twice";
  const int until_now = kept;
  tune(runtime_, small_encoders, tuning, [&] { ++kept; });
  EXPECT_EQ(kept, until_now) << "a second run tunes again";
  reset_to_defaults(tuning, small_encoders);
  EXPECT_TRUE(is_complete(tuning, small_encoders));
  for (const auto& layer : tuning.layers)
    EXPECT_EQ(layer.choice, ConvStack::default_configuration(layer.shape));
  EXPECT_EQ(tuning.micro_batches.front().images, ConvStack::micro_batch_windows);
  EncoderTrials trials(runtime_, small_encoders.front());
  EXPECT_TRUE(trials.make({}));
}

}  // namespace
}  // namespace touchtrace
