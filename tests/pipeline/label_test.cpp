#include "pipeline/label/label.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core/utility.hpp>

#include "calib/board/opencv_threads.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "pipeline/study/label_error.h"
#include "tests/pipeline/label_stage.h"
#include "tests/support/expect_error.h"
#include "tests/verify/labels/label_trials.h"

namespace touchtrace::staged {
namespace {

using Eigen::Vector3d;
using label::FrameSource;
using label::LabelOptions;

class LabelTest : public ::testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(LabelTest, TracksHandAndObject) {
  const auto& [tracker, thrown] = GetParam();
  const Stage stage(thrown);
  LabelOptions options;
  options.tracker = tracker;
  options.camera_latency_s = {0.0, 0.001};
  const auto labels =
      label_recording(recording_of(stage), frame_source(stage), calibration(), options);
  ASSERT_EQ(labels.time_s.size(), 88u);  // every counter value, the lost frame included
  EXPECT_EQ(std::ranges::count(labels.glove_frame, -1), 1);
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage));
  EXPECT_LE(error.object.wrong_share, 0.02);
  EXPECT_LE(error.object.lost_share, 0.05);
  // a pixel is 3.7 mm wide at that distance; depth is exact to 1 mm
  EXPECT_LT(error.object.position_spread_m.maxCoeff(), 0.004);
  EXPECT_LT(error.object.velocity_rms_m_per_s, thrown ? 0.16 : 0.09);
  EXPECT_LE(error.hand.wrong_share, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Trackers, LabelTest,
                         ::testing::Combine(::testing::Values("csrt", "component"),
                                            ::testing::Bool()));

TEST(Label, IgnoresTrousersOfTheGlovesColor) {
  Stage stage(false);
  stage.set_blue_trousers();
  auto recording = recording_of(stage);
  auto& times = recording.camera_times;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < times.frames(); ++i)
    if (i % 20 < 17) kept.push_back(i);  // three frames are lost each second
  CameraTimes arrived;
  for (const auto i : kept) {
    arrived.sequence.push_back(times.sequence[i]);
    arrived.device_time_s.push_back(times.device_time_s[i]);
    arrived.host_time_s.push_back(times.host_time_s[i]);
  }
  times = arrived;
  auto frames = frame_source(stage);
  const auto all = frames.camera_frame;
  frames.camera_frame = [&](std::size_t i) { return all(kept[i]); };
  const auto labels = label_recording(recording, frames, calibration(), component_options());
  EXPECT_EQ(study::compare_labels_with_truth(labels, truth_of(stage)).hand.wrong_share, 0.0);
}

study::BodyError error_with_component(const Stage& stage) {
  return study::compare_labels_with_truth(label_recording(recording_of(stage), frame_source(stage),
                                                          calibration(), component_options()),
                                          truth_of(stage))
      .object;
}

TEST(Label, AccountsForTheDelayOfDepthImages) {
  const Stage stage(false);
  const auto delay_s = [&](const RgbdCalibration& calibration) {
    const auto labels =
        label_recording(recording_of(stage), frame_source(stage), calibration, component_options());
    return study::compare_labels_with_truth(labels, truth_of(stage)).object.delay_s;
  };
  auto late = calibration();
  late.depth_delay_s = 0.015;
  EXPECT_NEAR(delay_s(late) - delay_s(calibration()), 0.015, 0.001);
}

TEST(Label, LearnsAnObjectThatIsHiddenInItsFirstFrame) {
  for (const bool thrown : {false, true}) {
    SCOPED_TRACE(thrown ? "thrown" : "waved");
    const auto error = error_with_component(Stage(thrown, Stage::Ball::hidden_at_first));
    EXPECT_LE(error.lost_share, 0.05);
    EXPECT_LE(error.wrong_share, 0.02);
    EXPECT_LT(error.position_spread_m.maxCoeff(),
              0.02);  // the offset from the hand is unknown at first
  }
}

TEST(Label, TracksAnObjectOfTheHandsColorInFlightAndFlagsItElsewhere) {
  const auto thrown = error_with_component(Stage(true, Stage::Ball::hand_colored));
  EXPECT_LE(thrown.lost_share + thrown.wrong_share, 0.05);
  EXPECT_EQ(thrown.wrong_unsaid_share, 0.0);
  EXPECT_GT(thrown.follows_share, 0.2);
  EXPECT_LT(thrown.follows_share, 0.95);
  const auto held = error_with_component(Stage(false, Stage::Ball::hand_colored));
  EXPECT_LE(held.lost_share + held.wrong_share, 0.05);
}

/// With the torso's colour as the rest's alone, the ball is never seen.
TEST(Label, TracksAnObjectOfTheTorsosColor) {
  for (const bool thrown : {false, true}) {
    SCOPED_TRACE(thrown ? "thrown" : "waved");
    const auto error = error_with_component(Stage(thrown, Stage::Ball::torso_colored));
    EXPECT_LE(error.lost_share, 0.05);
    EXPECT_EQ(error.wrong_unsaid_share, 0.0);
    EXPECT_LE(error.follows_share, 0.1);
    EXPECT_LT(error.position_spread_m.maxCoeff(), 0.005);
  }
}

/// Colours that are new near the hand are the object's only if they cover no more than its disc.
TEST(Label, DoesNotTakeTheTorsoForAnObjectOfTheHandsColor) {
  Stage stage(false, Stage::Ball::hand_colored);
  stage.set_relit_torso();
  const auto held = error_with_component(stage);
  EXPECT_LE(held.lost_share + held.wrong_share, 0.05);
  EXPECT_EQ(held.wrong_unsaid_share, 0.0);
}

TEST(Label, DoesNotDependOnThreads) {
  const Stage stage(true);
  auto recording = recording_of(stage);
  recording.clips = {recording.clips[0], recording.clips[0]};
  recording.clips[0].end_s = 2.0, recording.clips[1].start_s = 2.1;
  recording.clips[1].hand_box = box_around(stage.hand(2.1), 0.055);
  recording.clips[1].object_box = box_around(stage.ball(2.1), 0.036);
  LabelOptions options;
  options.num_threads = 1;
  const auto one = label_recording(recording, frame_source(stage), calibration(), options);
  options.num_threads = 4;
  const auto four = label_recording(recording, frame_source(stage), calibration(), options);
  EXPECT_EQ(one.object.position_m, four.object.position_m);
  EXPECT_EQ(one.hand.covariance, four.hand.covariance);
}

TEST(Label, RestoresTheNumberOfOpenCvThreads) {
  const OpenCvThreads three(3);
  const int threads = cv::getNumThreads();
  ASSERT_GT(threads, 1);
  const Stage stage(false);
  label_recording(recording_of(stage), frame_source(stage), calibration(), component_options());
  EXPECT_EQ(cv::getNumThreads(), threads);
}

TEST(Label, RethrowsTheErrorOfAnUnreadableImage) {
  const Stage stage(false);
  auto frames = frame_source(stage);
  const auto read = frames.camera_frame;
  frames.camera_frame = [&](std::size_t i) {
    if (i == 50) throw data_error("image 50 is damaged", "copy it again");
    return read(i);
  };
  for (const int threads : {1, 4}) {
    auto options = component_options();
    options.num_threads = threads;
    EXPECT_THROW(label_recording(recording_of(stage), frames, calibration(), options), Error);
  }
}

TEST(Label, KeepsTheOtherClipsIfOneCannotBeLabelled) {
  const Stage stage(false);
  auto recording = recording_of(stage);
  recording.clips = {recording.clips[0], recording.clips[0]};
  recording.clips[0].end_s = 3.0, recording.clips[1].start_s = 3.1;
  recording.clips[1].hand_box = {1, 1, 9, 9};
  auto options = component_options();
  options.camera_latency_s = {0.0, 0.001};
  const auto labels = label_recording(recording, frame_source(stage), calibration(), options);
  ASSERT_EQ(labels.summary["problems"].size(), 1u);
  EXPECT_EQ(labels.summary["problems"][0]["clip"], 1);
  for (std::size_t i = 0; i < labels.time_s.size(); ++i)
    EXPECT_EQ(labels.object.quality[i] & quality_lost, labels.clip[i] == 1 ? quality_lost : 0);
  EXPECT_DOUBLE_EQ(labels.summary["object_lost_share"].get<double>(),
                   static_cast<double>(std::ranges::count(labels.clip, 1)) /
                       static_cast<double>(labels.clip.size()));
}

/// Budgets add up to the covariance.
TEST(Label, StoresTheErrorBudget) {
  const Stage stage(false);
  const auto labels =
      label_recording(recording_of(stage), frame_source(stage), calibration(), component_options());
  const std::size_t sources = labels.summary["error_sources"].size();
  ASSERT_EQ(labels.object.error_budget_m.size(), sources * labels.time_s.size());
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    double sum_m2 = 0.0, trace_m2 = 0.0;
    for (std::size_t k = 0; k < sources; ++k)
      sum_m2 += std::pow(labels.object.error_budget_m[sources * i + k], 2);
    for (std::size_t k = 0; k < 3; ++k) trace_m2 += labels.object.covariance[36 * i + 7 * k];
    EXPECT_NEAR(3.0 * sum_m2 / trace_m2, 1.0, 1e-9);
  }
}

TEST(Label, RejectsIncompleteRecordings) {
  const Stage stage(false);
  const auto good = recording_of(stage);
  const auto expect_rejected = [&](const Recording& recording, const std::string& what) {
    testing::expect_error(
        [&] { label_recording(recording, frame_source(stage), calibration(), {}); }, what);
  };
  auto recording = good;
  recording.camera_times = {};
  expect_rejected(recording, "camera");
  recording = good;
  recording.clips.clear();
  expect_rejected(recording, "clip");
  recording = good;
  recording.clips[0].object_box = {};
  expect_rejected(recording, "boxes");
  recording = good;
  recording.clips[0].object_box = {1, 1, 5, 5};
  expect_rejected(recording, "object");
  recording = good;
  recording.camera.width = recording.camera.height = 480;
  expect_rejected(recording, "480");
}

/// From frame `first` on the hand is gone, and half of the ball has its colour.
label::FrameSource hand_leaves(const Stage& stage, std::size_t first) {
  auto frames = frame_source(stage);
  frames.camera_frame = [&stage, first, read = frames.camera_frame](std::size_t i) {
    const double time_s = static_cast<double>(i) / camera_rate_hz;
    if (i < first) return read(i);
    return render_pixels([&](const Eigen::Vector3d& ray, Pixel& pixel) {
      const Eigen::Vector3d ball_m = stage.ball(time_s);
      const bool is_left = ray.x() * ball_m.z() < ball_m.x();
      pixel.show(ball_depth_m(ray, ball_m), is_left ? blue : red);
    });
  };
  return frames;
}

TEST(Label, APartOfTheObjectIsNotTheHand) {
  const Stage stage(false);
  const std::size_t first = 90;
  const auto labels = label_recording(recording_of(stage), hand_leaves(stage, first), calibration(),
                                      component_options());
  const double gone_s = static_cast<double>(first) / camera_rate_hz;
  std::size_t before = 0, after = 0;
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    if (labels.hand.quality[i] != quality_good) continue;
    before += labels.time_s[i] < gone_s;
    after += labels.time_s[i] > gone_s + 0.4;
  }
  EXPECT_GT(before, 50u);
  EXPECT_EQ(after, 0u);
}

}  // namespace
}  // namespace touchtrace::staged
