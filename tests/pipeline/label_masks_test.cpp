// Masks of some or all frames.
#include <gtest/gtest.h>

#include "pipeline/label/learn/mask_boxes.h"
#include "pipeline/study/label_error.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::label {
namespace {

constexpr int mask_width = 40, mask_height = 30;

/// Mask with a rectangle for each body.
RgbdFrame masked_frame(const PixelBox& hand, const PixelBox& object) {
  RgbdFrame frame;
  for (int v = 0; v < mask_height; ++v)
    for (int u = 0; u < mask_width; ++u) {
      const SurfacePoint point{{}, static_cast<std::int16_t>(u), static_cast<std::int16_t>(v), {}};
      frame.mask.push_back(contains(hand, point)     ? mask_hand
                           : contains(object, point) ? mask_object
                                                     : mask_other);
    }
  return frame;
}

ClipFrames boxed_by(const std::vector<RgbdFrame>& masks) {
  FrameSource frames;
  frames.camera_frame = [&](std::size_t i) { return masks[i - 5]; };
  for (std::size_t i = 0; i < masks.size(); ++i) frames.masked_frames.push_back(5 + i);
  ClipFrames clip;
  clip.first = 5, clip.count = masks.size();
  set_mask_boxes(frames, mask_width, clip);
  return clip;
}

TEST(MaskBoxes, AreOfAFrameThatShowsBothBodiesNearEachOther) {
  const PixelBox object{20, 10, 8, 8}, rim{30, 0, 8, 1}, far{0, 20, 8, 8}, near{12, 10, 8, 8};
  const auto clip = boxed_by({masked_frame({}, object), masked_frame(rim, object),
                              masked_frame(far, object), masked_frame(near, object)});
  EXPECT_TRUE(clip.has_mask_boxes);
  EXPECT_EQ(clip.box_frame, 8u);
  EXPECT_EQ(clip.hand_box.x, near.x);
  EXPECT_EQ(clip.hand_box.height, near.height);
  EXPECT_EQ(clip.object_box.x, object.x);
}

TEST(MaskBoxes, NeedAFrameWithBothBodies) {
  const auto clip = boxed_by({masked_frame({}, {20, 10, 8, 8}), masked_frame({1, 1, 8, 8}, {})});
  EXPECT_FALSE(clip.has_mask_boxes);
  EXPECT_FALSE(clip.has_boxes());
}

}  // namespace
}  // namespace touchtrace::label

namespace touchtrace::staged {
namespace {

/// Every third frame has a mask, and hand and object have exchanged their colours in it.
label::FrameSource misleading_colors(const Stage& stage) {
  auto frames = frame_source(stage);
  const auto has_mask = [](std::size_t i) { return i % 3 == 1; };
  for (std::size_t i = 0; i < static_cast<std::size_t>(seconds * camera_rate_hz); ++i)
    if (has_mask(i)) frames.masked_frames.push_back(i);
  frames.camera_frame = [read = frames.camera_frame, has_mask](std::size_t i) {
    auto frame = read(i);
    for (std::size_t j = 0; has_mask(i) && j < frame.depth.size(); ++j) {
      const bool is_object = frame.color[3 * j] == 200, is_hand = frame.color[3 * j + 2] == 160;
      frame.mask.push_back(is_object ? mask_object : is_hand ? mask_hand : mask_other);
      if (is_object || is_hand) std::ranges::copy(is_object ? blue : red, &frame.color[3 * j]);
    }
    return frame;
  };
  return frames;
}

TEST(Label, UsesTheMasksOfSomeFrames) {
  const Stage stage(false);
  const auto labels = label_recording(recording_of(stage), misleading_colors(stage), calibration(),
                                      component_options());
  EXPECT_EQ(labels.summary["observer"], "depth-color and masks");
  const auto [hand, object] = study::compare_labels_with_truth(labels, truth_of(stage));
  EXPECT_LE(object.lost_share + object.wrong_share, 0.05);
  EXPECT_LE(hand.lost_share + hand.wrong_share, 0.05);
}

/// The first `count` frames have masks of one body alone.
label::FrameSource masks_of_one(const Stage& stage, std::uint8_t body, std::size_t count) {
  auto frames = frame_source(stage);
  for (std::size_t i = 0; i < count; ++i) frames.masked_frames.push_back(i);
  frames.camera_frame = [=, read = frames.camera_frame](std::size_t i) {
    auto frame = read(i);
    for (std::size_t j = 0; i < count && j < frame.depth.size(); ++j) {
      const bool is_body =
          body == mask_object ? frame.color[3 * j] == 200 : frame.color[3 * j + 2] == 160;
      frame.mask.push_back(is_body ? body : std::uint8_t{mask_other});
    }
    return frame;
  };
  return frames;
}

/// Masks of the hand alone do not hide an object that has its colour and a box, nor do those of
/// objects, of which whole data sets have nothing else, hide the hand.
TEST(Label, MasksOfOneBodyDoNotHideTheOther) {
  const Stage stage(false);
  const auto all = static_cast<std::size_t>(seconds * camera_rate_hz);
  for (const auto& frames :
       {masks_of_one(stage, mask_hand, 40), masks_of_one(stage, mask_object, all)}) {
    const auto labels =
        label_recording(recording_of(stage), frames, calibration(), component_options());
    EXPECT_EQ(labels.summary["observer"], "depth-color and masks");
    EXPECT_LE(labels.summary["object_follows_share"].get<double>() +
                  labels.summary["object_lost_share"].get<double>(),
              0.05);
  }
}

/// Data sets of object poses have masks of the object alone. Here its colour is soon that of the
/// hand.
TEST(Label, UsesMasksOfTheObjectAlone) {
  const Stage stage(false);
  auto frames =
      masks_of_one(stage, mask_object, static_cast<std::size_t>(seconds * camera_rate_hz));
  frames.camera_frame = [read = frames.camera_frame](std::size_t i) {
    auto frame = read(i);
    for (std::size_t j = 0; i >= 10 && j < frame.mask.size(); ++j)
      if (frame.mask[j] == mask_object) std::ranges::copy(blue, &frame.color[3 * j]);
    return frame;
  };
  const auto labels =
      label_recording(recording_of(stage), frames, calibration(), component_options());
  const auto [hand, object] = study::compare_labels_with_truth(labels, truth_of(stage));
  EXPECT_LE(object.lost_share + object.wrong_share, 0.05);
  EXPECT_LE(hand.lost_share + hand.wrong_share, 0.05);
}

}  // namespace
}  // namespace touchtrace::staged
