#include "pipeline/label/label.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"
#include "pipeline/study/label_error.h"
#include "pipeline/study/tracker_choice.h"
#include "tests/pipeline/label_stage.h"
#include "tests/verify/labels/label_trials.h"

namespace touchtrace::staged {
namespace {

using Eigen::Vector3d;
using label::FrameSource;
using label::LabelOptions;

class LabelTest : public ::testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(LabelTest, FollowsHandAndObject) {
  const auto& [tracker, thrown] = GetParam();
  const Stage stage(thrown);
  LabelOptions options;
  options.tracker = tracker;
  const auto labels =
      label_recording(recording_of(stage), frames_of(stage), calibration(), options);
  ASSERT_EQ(labels.time_s.size(), 88u);  // every number of the counter, the lost frame too
  EXPECT_EQ(std::ranges::count(labels.glove_frame, -1), 1);
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage));
  EXPECT_LE(error.object.wrong_share, 0.02);
  EXPECT_LE(error.object.lost_share, 0.05);
  // a pixel is 3.7 mm at that distance and the depth is exact to a millimetre
  EXPECT_LT(error.object.position_spread_m.maxCoeff(), 0.004);
  EXPECT_LT(error.object.velocity_rms_m_per_s, thrown ? 0.16 : 0.09);
  EXPECT_LE(error.hand.wrong_share, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Trackers, LabelTest,
                         ::testing::Combine(::testing::Values("csrt", "csrt-fast", "kcf",
                                                              "component"),
                                            ::testing::Bool()));

TEST(Label, TrousersOfTheGlovesColourDoNotDrawTheHandAway) {
  Stage stage(false);
  stage.wear_blue();
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
  auto frames = frames_of(stage);
  const auto all = frames.camera_frame;
  frames.camera_frame = [&](std::size_t i) { return all(kept[i]); };
  LabelOptions options;
  options.tracker = "component";
  const auto labels = label_recording(recording, frames, calibration(), options);
  EXPECT_EQ(study::compare_labels_with_truth(labels, truth_of(stage)).hand.wrong_share, 0.0);
}

study::BodyError error_with_component(const Stage& stage) {
  LabelOptions options;
  options.tracker = "component";
  return study::compare_labels_with_truth(
             label_recording(recording_of(stage), frames_of(stage), calibration(), options),
             truth_of(stage))
      .object;
}

TEST(Label, PlacesBelongToTheTimeOfWhatDepthImagesShow) {
  const Stage stage(false);
  LabelOptions options;
  options.tracker = "component";
  const auto delay_s = [&](const RgbdCalibration& calibration) {
    const auto labels =
        label_recording(recording_of(stage), frames_of(stage), calibration, options);
    return study::compare_labels_with_truth(labels, truth_of(stage)).object.delay_s;
  };
  auto late = calibration();
  late.depth_delay_s = 0.015;
  EXPECT_NEAR(delay_s(late) - delay_s(calibration()), 0.015, 0.001);
}

TEST(Label, AnObjectThatIsHiddenAtFirstIsKnownOnceItShows) {
  for (const bool thrown : {false, true}) {
    SCOPED_TRACE(thrown ? "thrown" : "waved");
    const auto error = error_with_component(Stage(thrown, Stage::Ball::hidden_at_first));
    EXPECT_LE(error.lost_share, 0.05);
    EXPECT_LE(error.wrong_share, 0.02);
    EXPECT_LT(error.position_spread_m.maxCoeff(), 0.02);  // some of the hand's motion is in it
  }
}

TEST(Label, AnObjectLikeTheHandIsSeenInFlightAndSaidToFollowElsewhere) {
  const auto thrown = error_with_component(Stage(true, Stage::Ball::like_the_hand));
  EXPECT_LE(thrown.lost_share + thrown.wrong_share, 0.05);
  EXPECT_EQ(thrown.wrong_unsaid_share, 0.0);
  EXPECT_GT(thrown.follows_share, 0.2);
  EXPECT_LT(thrown.follows_share, 0.95);
  const auto held = error_with_component(Stage(false, Stage::Ball::like_the_hand));
  EXPECT_LE(held.lost_share + held.wrong_share, 0.05);
}

TEST(Label, DoesNotDependOnThreads) {
  const Stage stage(true);
  auto recording = recording_of(stage);
  recording.clips = {recording.clips[0], recording.clips[0]};
  recording.clips[0].end_s = 2.0, recording.clips[1].start_s = 2.1;
  recording.clips[1].hand_box = box_around(stage.hand(2.1), 0.055);
  recording.clips[1].object_box = box_around(stage.ball(2.1), 0.036);
  LabelOptions options;
  options.threads = 1;
  const auto one = label_recording(recording, frames_of(stage), calibration(), options);
  options.threads = 4;
  const auto four = label_recording(recording, frames_of(stage), calibration(), options);
  EXPECT_EQ(one.object.position_m, four.object.position_m);
  EXPECT_EQ(one.hand.covariance, four.hand.covariance);
}

TEST(Label, ATrackerIsProposedByTheColours) {
  const auto proposed = [](Stage::Ball ball) {
    const Stage stage(false, ball);
    return study::choose_tracker(recording_of(stage), frames_of(stage)).tracker;
  };
  EXPECT_EQ(proposed(Stage::Ball::red), "component");
  EXPECT_EQ(proposed(Stage::Ball::like_the_hand), "csrt-fast");
  EXPECT_EQ(proposed(Stage::Ball::hidden_at_first), "csrt-fast");
}

TEST(Label, EndsWithTheImageThatCannotBeRead) {
  const Stage stage(false);
  auto frames = frames_of(stage);
  const auto sound = frames.camera_frame;
  frames.camera_frame = [&](std::size_t i) {
    if (i == 50) throw data_error("image 50 is damaged", "copy it again");
    return sound(i);
  };
  for (const int threads : {1, 4}) {
    LabelOptions options;
    options.tracker = "component";
    options.threads = threads;
    EXPECT_THROW(label_recording(recording_of(stage), frames, calibration(), options), Error);
  }
}

TEST(Label, SaysWhatIsMissing) {
  const Stage stage(false);
  const auto good = recording_of(stage);
  const auto frames = frames_of(stage);
  const auto refused = [&](const Recording& recording, const FrameSource& source,
                           const std::string& what) {
    try {
      label_recording(recording, source, calibration(), {});
      ADD_FAILURE() << "not refused: " << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data);
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  auto recording = good;
  recording.gloves.clear();
  refused(recording, frames, "glove");
  recording = good;
  recording.camera_times = {};
  refused(recording, frames, "camera");
  recording = good;
  recording.clips.clear();
  refused(recording, frames, "clips");
  recording = good;
  recording.clips[0].object_box = {};
  refused(recording, frames, "boxes");
  recording = good;
  recording.clips[0].object_box = {1, 1, 5, 5};
  refused(recording, frames, "object");
  auto source = frames;
  source.background_frames = 0;
  refused(good, source, "background");
}

}  // namespace
}  // namespace touchtrace::staged
