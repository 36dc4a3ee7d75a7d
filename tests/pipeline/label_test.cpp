#include "pipeline/label/label.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/smooth/synthetic_track.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "pipeline/study/label_error.h"
#include "pipeline/study/label_trials.h"
#include "pipeline/study/tracker_choice.h"

namespace touchtrace {
namespace {

using Eigen::Vector3d;
using label::FrameSource;
using label::LabelOptions;

constexpr int width = 320, height = 240;
constexpr double ball_radius_m = 0.035, camera_rate_hz = 20.0, glove_rate_hz = 15.0, seconds = 6.0,
                 hidden_s = 0.5;
const Vector3d ball_at(0.0, 0.0, 1.1), hand_from_ball(0.0, 0.07, 0.02);

Camera camera() {
  Camera result;
  result.width = width, result.height = height;
  result.fx = result.fy = 300.0;
  result.cx = 159.5, result.cy = 119.5;
  return result;
}

/// A red ball, a blue disc of a hand, a grey torso and a wall, seen by a perfect camera at the
/// colour camera's place.
class Stage {
 public:
  enum class Ball { red, like_the_hand, hidden_at_first };

  explicit Stage(bool thrown, Ball kind = Ball::red)
      : motion_(thrown ? synthetic_throw(seconds + 1.0, 3) : synthetic_wave(seconds + 1.0, 3)),
        kind_(kind) {}

  Vector3d ball(double time_s) const { return ball_at + motion_.position_at(time_s); }
  /// Under the ball or, while that flies, on its way from where it left to where it lands.
  Vector3d hand(double time_s) const {
    for (const auto& [release_s, landing_s, release_sigma_s, landing_sigma_s] : motion_.flights)
      if (time_s > release_s && time_s < landing_s) {
        const double part = (time_s - release_s) / (landing_s - release_s);
        return hand_from_ball + (1.0 - part) * ball(release_s) + part * ball(landing_s);
      }
    return hand_from_ball + ball(time_s);
  }
  const SyntheticMotion& motion() const { return motion_; }
  /// Trousers of the glove's colour, larger than it.
  void wear_blue() { trousers_ = {20, 30, 160}; }

  RgbdFrame look(double time_s, bool person) const {
    RgbdFrame frame{std::vector<std::uint8_t>(3 * width * height),
                    std::vector<std::uint16_t>(width * height)};
    const Vector3d ball_m = ball(time_s), hand_m = hand(time_s);
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const auto at = static_cast<std::size_t>(v * width + u);
        const Vector3d ray = camera().unproject({u, v});
        double depth = 2.5;
        std::array<int, 3> color{120, 120, 110};
        if (person && std::abs(ray.x()) < 0.15)
          depth = 1.5, color = ray.y() > 0.15 ? trousers_ : std::array<int, 3>{90, 60, 60};
        if (person && (ray * hand_m.z() - hand_m).norm() < 0.05)
          depth = hand_m.z(), color = {20, 30, 160};
        const double b = ray.dot(ball_m), q = ray.squaredNorm();
        const double discriminant =
            b * b - q * (ball_m.squaredNorm() - ball_radius_m * ball_radius_m);
        if (person && discriminant > 0.0 && (b - std::sqrt(discriminant)) / q < depth)
          depth = (b - std::sqrt(discriminant)) / q, color = ball_color(time_s);
        frame.depth[at] = static_cast<std::uint16_t>(std::lround(1000.0 * depth));
        for (std::size_t c = 0; c < 3; ++c)
          frame.color[3 * at + c] = static_cast<std::uint8_t>(color[c]);
      }
    return frame;
  }

 private:
  /// A ball that is wholly in the glove looks like it.
  std::array<int, 3> ball_color(double time_s) const {
    const bool gloved =
        kind_ == Ball::like_the_hand || (kind_ == Ball::hidden_at_first && time_s < hidden_s);
    return gloved ? std::array<int, 3>{20, 30, 160} : std::array<int, 3>{200, 40, 20};
  }

  SyntheticMotion motion_;
  Ball kind_;
  std::array<int, 3> trousers_{90, 60, 60};
};

PixelBox box_around(const Vector3d& center, double radius_m) {
  const Eigen::Vector2d pixel = camera().project(center);
  const int half = static_cast<int>(std::lround(radius_m * camera().fx / center.z()));
  return {static_cast<int>(pixel.x()) - half, static_cast<int>(pixel.y()) - half, 2 * half,
          2 * half};
}

Recording recording_of(const Stage& stage) {
  Recording recording;
  recording.activity = "test";
  recording.camera.width = width, recording.camera.height = height;
  recording.camera.rate_hz = camera_rate_hz;
  recording.clips = {{0.0, seconds, "ball", false, box_around(stage.hand(0.0), 0.055),
                      box_around(stage.ball(0.0), 0.036)}};
  for (int i = 0; i < static_cast<int>(seconds * camera_rate_hz); ++i) {
    recording.camera_times.sequence.push_back(static_cast<std::uint64_t>(i));
    recording.camera_times.device_time_s.push_back(i / camera_rate_hz);
    recording.camera_times.host_time_s.push_back(i / camera_rate_hz);
  }
  GloveStream glove;
  for (int i = 0; i < static_cast<int>((seconds - 0.1) * glove_rate_hz); ++i) {
    if (i == 40) continue;  // lost on the way
    glove.sequence.push_back(static_cast<std::uint64_t>(i + 100));
    glove.host_time_s.push_back(i / glove_rate_hz);
  }
  recording.gloves = {glove};
  return recording;
}

FrameSource frames_of(const Stage& stage) {
  return {[&](std::size_t i) { return stage.look(static_cast<double>(i) / camera_rate_hz, true); },
          [&](std::size_t) { return stage.look(0.0, false); }, 3};
}

Truth truth_of(const Stage& stage) {
  Truth truth;
  for (int i = 0; i < static_cast<int>(seconds * 500.0); ++i) {
    const double t = i / 500.0;
    truth.time_s.push_back(t);
    truth.clip.push_back(0);
    const auto add = [](std::vector<double>& to, const Vector3d& v) {
      to.insert(to.end(), v.data(), v.data() + 3);
    };
    add(truth.object.position_m, stage.ball(t));
    add(truth.object.velocity_m_per_s, stage.motion().velocity_at(t));
    add(truth.hand.position_m, stage.hand(t));
    add(truth.hand.velocity_m_per_s, (stage.hand(t + 1e-3) - stage.hand(t)) / 1e-3);
  }
  return truth;
}

RgbdCalibration calibration() {
  RgbdCalibration result;
  result.color = camera();
  result.depth = camera();
  return result;
}

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

TEST(Label, ExactPositionsLeaveTheCamerasRateAsTheOnlyError) {
  const Stage stage(false);
  const auto error = study::error_of_exact_positions(recording_of(stage), truth_of(stage));
  EXPECT_EQ(error.object.lost_share + error.object.wrong_share, 0.0);
  EXPECT_LT(error.object.position_spread_m.maxCoeff(), 0.001);
  EXPECT_LT(error.object.aligned_velocity_rms_m_per_s, 0.05);
}

TEST(Label, AnErrorIsMeasuredAtTheDelayThatNoStampShows) {
  const Stage stage(false);
  auto recording = recording_of(stage);
  for (auto& time_s : recording.camera_times.host_time_s) time_s += 0.018;
  LabelOptions options;
  options.tracker = "component";
  const auto labels = label_recording(recording, frames_of(stage), calibration(), options);
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage)).object;
  EXPECT_NEAR(error.delay_s, 0.018, 0.001);
  EXPECT_LT(error.aligned_velocity_rms_m_per_s, 0.5 * error.velocity_rms_m_per_s);
}

TEST(Label, WhatNothingTellsIsNoNumber) {
  const Stage stage(false);
  LabelOptions options;
  options.tracker = "component";
  const auto labels =
      label_recording(recording_of(stage), frames_of(stage), calibration(), options);
  auto truth = truth_of(stage);
  auto& velocity = truth.object.velocity_m_per_s;
  for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = i / 3 % 2 ? 10.0 : -10.0;
  const auto error = study::compare_labels_with_truth(labels, truth).object;
  EXPECT_EQ(error.impact_share, 1.0);
  EXPECT_TRUE(std::isfinite(error.position_spread_m.norm()));
  for (const double unknown : {error.velocity_rms_m_per_s, error.causal_velocity_rms_m_per_s,
                               error.aligned_velocity_rms_m_per_s, error.position_coverage,
                               error.velocity_coverage, error.nees})
    EXPECT_TRUE(std::isnan(unknown));
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
}  // namespace touchtrace
