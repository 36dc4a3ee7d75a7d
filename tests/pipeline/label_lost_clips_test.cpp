// Clips of which a body has no labels.
#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/label/states/lost_clips.h"
#include "pipeline/label/states/summary.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::label {
namespace {

/// Clip of 10 frames.
struct SampleClip {
  std::vector<ClipFrames> clips = std::vector<ClipFrames>(1);
  std::vector<ClipTrack> tracks = std::vector<ClipTrack>(1);

  explicit SampleClip(double period_s = 0.1) {
    clips[0].count = 10;
    for (int i = 0; i < 10; ++i) tracks[0].time_s.push_back(period_s * i);
    Observation found;
    found.found = true;
    tracks[0].hand.assign(10, found), tracks[0].object.assign(10, found);
  }
};

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Both bodies are found in frames 4 and 5.
SampleClip mostly_lost(double period_s) {
  SampleClip sample(period_s);
  for (const int i : {0, 2, 3, 6, 7, 8, 9}) sample.tracks[0].object[i].found = false;
  for (const int i : {0, 1, 2, 3, 6, 7}) sample.tracks[0].hand[i].found = false;
  return sample;
}

TEST(LostClips, NameTheLongestTimeWithBothBodies) {
  SampleClip sample = mostly_lost(2.0);
  drop_lost_clips(sample.clips, sample.tracks);
  const auto& problem = sample.clips[0].problem;
  EXPECT_TRUE(mentions(problem, "hand lost in 60 %, object lost in 70 %")) << problem;
  EXPECT_TRUE(mentions(problem, "from 8.00 to 10.00 s")) << problem;
  EXPECT_TRUE(mentions(problem, "import --clips")) << problem;
  EXPECT_TRUE(sample.tracks[0].time_s.empty());
}

TEST(LostClips, OfUnderTwoSecondsAreNotProposed) {
  SampleClip sample = mostly_lost(0.1);
  drop_lost_clips(sample.clips, sample.tracks);
  EXPECT_TRUE(mentions(sample.clips[0].problem, "touchtrace mark")) << sample.clips[0].problem;
  EXPECT_FALSE(mentions(sample.clips[0].problem, "import --clips")) << sample.clips[0].problem;
}

TEST(LostClips, KeepTheBodyThatIsFound) {
  SampleClip sample;
  for (int i = 0; i < 6; ++i) sample.tracks[0].hand[i].found = false;
  ::testing::internal::CaptureStderr();
  drop_lost_clips(sample.clips, sample.tracks);
  EXPECT_TRUE(mentions(::testing::internal::GetCapturedStderr(), "clip 0: hand lost in 60 %"));
  EXPECT_TRUE(sample.clips[0].is_usable());
  EXPECT_EQ(lost_fraction(sample.tracks[0].hand), 1.0);
  EXPECT_EQ(lost_fraction(sample.tracks[0].object), 0.0);
}

TEST(LostClips, NameTheTimesOfABodyThatIsFoundAlone) {
  for (const bool is_object : {true, false}) {
    SampleClip sample(1.0);
    auto &hand = sample.tracks[0].hand, &object = sample.tracks[0].object;
    (is_object ? hand : object).assign(10, {});
    auto& found = is_object ? object : hand;
    std::fill(found.begin() + 4, found.end(), Observation{});
    drop_lost_clips(sample.clips, sample.tracks);
    EXPECT_TRUE(mentions(sample.clips[0].problem,
                         is_object ? "the object alone is found from 0.00 to 3.00 s"
                                   : "the hand alone is found from 0.00 to 3.00 s"))
        << sample.clips[0].problem;
  }
}

TEST(LostClips, IncludeAnObjectThatMovesWithALostHand) {
  SampleClip sample;
  for (int i = 0; i < 6; ++i) sample.tracks[0].hand[i].found = false;
  for (int i = 2; i < 8; ++i) sample.tracks[0].object[i].follows_hand = true;
  drop_lost_clips(sample.clips, sample.tracks);
  EXPECT_TRUE(mentions(sample.clips[0].problem, "hand lost in 60 %, object lost in 60 %"));
}

TEST(LostClips, WarnOfAnObjectThatIsMostlyHidden) {
  for (const int num_hidden : {5, 6}) {
    SampleClip sample;
    for (int i = 0; i < num_hidden; ++i) sample.tracks[0].object[i].follows_hand = true;
    ::testing::internal::CaptureStderr();
    drop_lost_clips(sample.clips, sample.tracks);
    EXPECT_EQ(mentions(::testing::internal::GetCapturedStderr(),
                       "clip 0: the hand hides the object in 60 %"),
              num_hidden == 6);
    EXPECT_TRUE(sample.clips[0].is_usable());
  }
}

TEST(LostClips, IncludeThoseWithoutSmoothedMotion) {
  for (const bool is_smooth : {true, false}) {
    SampleClip sample;
    SmoothedBodies bodies;
    bodies.hand.tracks.resize(1), bodies.object.tracks.resize(1);
    bodies.hand.tracks[0].status = SmoothStatus::converged;
    bodies.object.tracks[0].status =
        is_smooth ? SmoothStatus::converged : SmoothStatus::not_converged;
    drop_unsmoothed_clips(sample.clips, sample.tracks, bodies);
    EXPECT_EQ(sample.clips[0].is_usable(), is_smooth);
    if (is_smooth) continue;
    EXPECT_TRUE(mentions(sample.clips[0].problem, "object do not fit a smooth motion"));
    EXPECT_EQ(bodies.hand.tracks[0].status, SmoothStatus::no_samples);
    EXPECT_THROW(require_usable_clip(sample.clips), Error);
  }
}

}  // namespace
}  // namespace touchtrace::label

namespace touchtrace::staged {
namespace {

/// Both bodies leave the picture after a third of the time.
label::FrameSource leaving(const Stage& stage) {
  auto frames = frame_source(stage);
  frames.camera_frame = [&stage, read = frames.camera_frame](std::size_t i) {
    return i < 40 ? read(i) : stage.render(0.0, false);
  };
  return frames;
}

TEST(Label, ReturnsWhatItMeasuredInARefusedRecording) {
  const Stage stage(false);
  Labels measured;
  EXPECT_THROW(
      label_recording(recording_of(stage), leaving(stage), calibration(), component_options(),
                      [&](const Labels& labels) { measured = labels; }),
      Error);
  ASSERT_EQ(measured.raw.time_s.size(), static_cast<std::size_t>(seconds * camera_rate_hz));
  EXPECT_TRUE(std::isfinite(measured.raw.hand_m[3 * 20]));
  EXPECT_TRUE(std::isnan(measured.raw.hand_m[3 * 80]));
}

/// What labelling prints with such boxes.
std::string printed_with(const PixelBox& hand_box, const PixelBox& object_box) {
  const Stage stage(false);
  auto recording = recording_of(stage);
  if (hand_box.width > 0) recording.clips[0].hand_box = hand_box;
  if (object_box.width > 0) recording.clips[0].object_box = object_box;
  ::testing::internal::CaptureStderr();
  try {
    label_recording(recording, frame_source(stage), calibration(), component_options());
  } catch (const Error&) {
  }
  return ::testing::internal::GetCapturedStderr();
}

TEST(Label, WarnsOfHandsOfAnotherSize) {
  EXPECT_NE(printed_with({100, 50, 130, 150}, {})
                .find("hand's box in camera frame 0 is 0.485 x 0.560 m, larger than a hand"),
            std::string::npos);
  const PixelBox usual = recording_of(Stage(false)).clips[0].hand_box;
  EXPECT_NE(printed_with({usual.x + usual.width / 2 - 4, usual.y + usual.height / 2 - 4, 8, 8}, {})
                .find("m, smaller than a hand"),
            std::string::npos);
  EXPECT_EQ(printed_with({}, {}).find("than a hand"), std::string::npos);
}

TEST(Label, WarnsOfBoxesThatAreFarApart) {
  const PixelBox on_the_torso{150, 10, 20, 20};
  EXPECT_NE(printed_with({}, on_the_torso).find("box in camera frame 0 are 0."), std::string::npos);
  EXPECT_EQ(printed_with({}, {}).find("m apart"), std::string::npos);
}

}  // namespace
}  // namespace touchtrace::staged
