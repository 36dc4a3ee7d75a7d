// Recordings as other programs give them: no glove, no calibration, no images of the empty scene,
// masks in place of boxes.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/label/label.h"
#include "pipeline/study/label_error.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::staged {
namespace {

using label::FrameSource;
using label::LabelOptions;

/// A frame in the middle of the clip in which the hand holds the object.
std::size_t held_frame(const Stage& stage) {
  std::size_t frame = 60;
  const auto is_in_flight = [&](const auto& flight) {
    const double time_s = static_cast<double>(frame) / camera_rate_hz;
    return time_s > flight.release_s - 0.1 && time_s < flight.landing_s + 0.1;
  };
  while (std::ranges::any_of(stage.motion().flights, is_in_flight)) ++frame;
  return frame;
}

/// What an import of a colour and a registered depth stream has: no glove, no calibration, no
/// images of the empty scene; boxes in the clip's middle.
Recording imported(const Stage& stage) {
  auto recording = recording_of(stage);
  recording.gloves.clear();
  recording.camera.is_registered = true;
  recording.camera.color_camera = camera();
  auto& clip = recording.clips[0];
  clip.box_frame = held_frame(stage);
  const double time_s = static_cast<double>(*clip.box_frame) / camera_rate_hz;
  clip.hand_box = box_around(stage.hand(time_s), 0.055);
  clip.object_box = box_around(stage.ball(time_s), 0.036);
  return recording;
}

FrameSource without_background(const Stage& stage) {
  auto frames = frame_source(stage);
  frames.background_frames = 0;
  return frames;
}

/// Labels and evaluates a recording without glove at all its camera frames.
study::BodyError error_of_imported(const Stage& stage, const FrameSource& frames) {
  const auto labels = label_recording(imported(stage), frames, std::nullopt, component_options());
  EXPECT_EQ(labels.time_s.size(), static_cast<std::size_t>(seconds * camera_rate_hz));
  EXPECT_EQ(std::ranges::count(labels.glove_frame, -1),
            static_cast<std::ptrdiff_t>(labels.time_s.size()));
  return study::compare_labels_with_truth(labels, truth_of(stage)).object;
}

TEST(Label, NeedsNoGloveNoCalibrationAndNoBackground) {
  for (const bool thrown : {false, true}) {
    SCOPED_TRACE(thrown ? "thrown" : "waved");
    const Stage stage(thrown);
    const auto error = error_of_imported(stage, without_background(stage));
    EXPECT_LE(error.wrong_share, 0.02);
    EXPECT_LE(error.lost_share, 0.05);
    EXPECT_LT(error.position_spread_m.maxCoeff(), 0.004);
  }
}

TEST(Label, FollowsAutoExposureAndWhiteBalance) {
  const Stage stage(false);
  auto frames = without_background(stage);
  frames.camera_frame = [&, read = frames.camera_frame](std::size_t i) {
    auto frame = read(i);
    const double part = static_cast<double>(i) / (seconds * camera_rate_hz);
    const std::array gains{1.0 - 0.5 * part, 1.0, 0.6 + 0.6 * part};
    for (std::size_t j = 0; j < frame.color.size(); ++j)
      frame.color[j] = static_cast<std::uint8_t>(std::min(255.0, frame.color[j] * gains[j % 3]));
    return frame;
  };
  const auto error = error_of_imported(stage, frames);
  EXPECT_LE(error.lost_share + error.wrong_share, 0.05);
}

TEST(Label, UsesHalfOfTheDepthPixels) {
  const Stage stage(false);
  auto frames = without_background(stage);
  frames.camera_frame = [read = frames.camera_frame](std::size_t i) {
    auto frame = read(i);
    const RandomStream random(i, "holes");
    for (std::size_t j = 0; j < frame.depth.size(); ++j)
      if (random.uniform_at(j) < 0.5) frame.depth[j] = 0;
    return frame;
  };
  const auto error = error_of_imported(stage, frames);
  EXPECT_LE(error.lost_share + error.wrong_share, 0.05);
  EXPECT_LT(error.position_spread_m.maxCoeff(), 0.006);
}

/// Adds masks by colour, as a segmentation network gives them, to some frames.
FrameSource masked(FrameSource frames, const std::function<bool(std::size_t)>& has_mask) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(seconds * camera_rate_hz); ++i)
    if (has_mask(i)) frames.masked_frames.push_back(i);
  frames.camera_frame = [read = frames.camera_frame, has_mask](std::size_t i) {
    auto frame = read(i);
    for (std::size_t j = 0; has_mask(i) && j < frame.depth.size(); ++j)
      frame.mask.push_back(frame.color[3 * j] == 200       ? mask_object
                           : frame.color[3 * j + 2] == 160 ? mask_hand
                                                           : mask_other);
    return frame;
  };
  return frames;
}

Labels label_without_boxes(const Stage& stage, const FrameSource& frames) {
  auto recording = imported(stage);
  recording.clips[0].hand_box = recording.clips[0].object_box = {};
  recording.clips[0].box_frame.reset();
  return label_recording(recording, frames, std::nullopt, component_options());
}

TEST(Label, TakesHandAndObjectFromMasks) {
  const Stage stage(false);
  auto frames = masked(without_background(stage), [](std::size_t i) { return i % 10 != 3; });
  frames.camera_frame = [read = frames.camera_frame](std::size_t i) {
    auto frame = read(i);
    std::ranges::fill(frame.color, std::uint8_t{90});
    return frame;
  };
  const auto labels = label_without_boxes(stage, frames);
  EXPECT_EQ(labels.summary["observer"], "masks");
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage)).object;
  EXPECT_NEAR(error.lost_share, 0.1, 0.02);
  EXPECT_EQ(error.wrong_share, 0.0);
  EXPECT_LT(error.position_spread_m.maxCoeff(), 0.004);
}

TEST(Label, FewMasksReplaceTheBoxes) {
  const Stage stage(false);
  const auto frames = masked(without_background(stage), [](std::size_t i) { return i == 47; });
  const auto labels = label_without_boxes(stage, frames);
  EXPECT_EQ(labels.summary["observer"], "depth-color and masks");
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage)).object;
  EXPECT_LE(error.lost_share, 0.05);
  EXPECT_LE(error.wrong_share, 0.02);
}

}  // namespace
}  // namespace touchtrace::staged
