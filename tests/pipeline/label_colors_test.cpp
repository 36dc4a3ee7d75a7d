#include <gtest/gtest.h>

#include "pipeline/label/learn/learn_colors.h"
#include "tests/pipeline/label_stage.h"

namespace touchtrace::label {
namespace {

using Color = std::array<std::uint8_t, 3>;

constexpr PixelBox hand_box{10, 10, 20, 20}, object_box{30, 10, 20, 20};
constexpr Color skin{200, 130, 100}, sleeve{190, 180, 170}, ball{30, 160, 40}, bar{60, 60, 140};

void add(Surface& surface, int count, const Color& color, const PixelBox& box, float depth_m) {
  for (int i = 0; i < count; ++i)
    surface.push_back({{0.0f, 0.0f, depth_m},
                       static_cast<std::int16_t>(box.x + i % box.width),
                       static_cast<std::int16_t>(box.y + i % box.height),
                       color});
}

/// A hand with some of its sleeve in its box, the ball that it holds, and the rest of the sleeve.
Surface person() {
  Surface surface;
  add(surface, 400, skin, hand_box, 0.8f);
  add(surface, 100, sleeve, hand_box, 0.8f);
  add(surface, 300, ball, object_box, 0.8f);
  add(surface, 1000, sleeve, {100, 100, 50, 50}, 0.9f);
  return surface;
}

ColorClasses learnt(const Surface& surface) {
  ColorClasses classes;
  classes.learn(surface, hand_box, object_box, false);
  classes.build_table();
  return classes;
}

/// A room of many colours, 2 m behind the hand, does not make the sleeve's colour rare.
TEST(ColorClasses, AreLearntAgainstTheArmWhateverTheRoomIs) {
  Surface surface = person();
  for (int i = 0; i < 20000; ++i)
    add(surface, 1,
        {static_cast<std::uint8_t>(i % 97), static_cast<std::uint8_t>(i % 89),
         static_cast<std::uint8_t>(i % 83)},
        {200, 100, 50, 50}, 3.0f);
  for (const auto& classes : {learnt(person()), learnt(surface)}) {
    EXPECT_EQ(classes.classify(skin), Body::hand);
    EXPECT_EQ(classes.classify(ball), Body::object);
    EXPECT_EQ(classes.classify(sleeve), Body::rest);
  }
}

/// A wall of the skin's colour does not become the hand: it is more frequent there.
TEST(ColorClasses, OfTheRoomAreNotTheHands) {
  constexpr Color shadow{60, 40, 30};
  Surface surface = person();
  add(surface, 30, shadow, hand_box, 0.8f);
  EXPECT_EQ(learnt(surface).classify(shadow), Body::hand);
  add(surface, 5000, shadow, {200, 100, 50, 50}, 3.0f);
  EXPECT_EQ(learnt(surface).classify(shadow), Body::rest);
}

/// Colours learnt from a bar through the fist, whose box also contains much of the sleeve.
/// `skin_alone`: points of skin outside it.
ColorClasses learnt_with_bar(int skin_alone, int bar_in_fist, int bar_beyond) {
  constexpr PixelBox bar_box{15, 0, 45, 40}, in_both{15, 10, 15, 20},
      beyond_the_fist{31, 0, 29, 40}, left_of_the_bar{10, 10, 4, 20};
  SampledFrames samples{{nullptr, 0, {}}};
  Surface& surface = samples.front().surface;
  add(surface, skin_alone, skin, left_of_the_bar, 0.8f);
  add(surface, 300, skin, in_both, 0.8f);
  add(surface, bar_in_fist, bar, in_both, 0.8f);
  add(surface, bar_beyond, bar, beyond_the_fist, 0.8f);
  add(surface, 300, sleeve, beyond_the_fist, 0.9f);
  add(surface, 30, skin, beyond_the_fist, 0.8f);  // a finger outside the hand's box
  add(surface, 1000, sleeve, {100, 100, 50, 50}, 0.9f);
  const ClipFrames clip{0, 1, hand_box, bar_box, "bar"};
  samples.front().clip = &clip;
  const Segmenter segmenter(staged::calibration(),
                            staged::recording_of(staged::Stage(false)).camera);
  return learn_colors(segmenter, "bar", samples, 1).classes;
}

void expect_all_classes(const ColorClasses& classes) {
  EXPECT_EQ(classes.classify(skin), Body::hand);
  EXPECT_EQ(classes.classify(bar), Body::object);
  EXPECT_EQ(classes.classify(sleeve), Body::rest);
}

TEST(LearnColors, OfAHandInsideTheObjectsBox) { expect_all_classes(learnt_with_bar(0, 100, 400)); }

/// Skin outside the bar's box shows the hand's colours, although the fist shows most of the bar.
TEST(LearnColors, OfAHandMostlyInsideTheObjectsBox) {
  expect_all_classes(learnt_with_bar(60, 400, 60));
}

/// A ball in front of the hand: fingers are few in its box.
TEST(ColorClasses, OfAnObjectInsideTheHandsBox) {
  constexpr PixelBox in_hand{15, 15, 12, 12};
  Surface surface;
  add(surface, 200, skin, {10, 10, 20, 5}, 0.8f);
  add(surface, 250, ball, in_hand, 0.8f);
  add(surface, 60, skin, in_hand, 0.8f);
  ColorClasses classes;
  classes.learn(surface, hand_box, in_hand, false);
  classes.build_table();
  EXPECT_EQ(classes.classify(skin), Body::hand);
  EXPECT_EQ(classes.classify(ball), Body::object);
}

}  // namespace
}  // namespace touchtrace::label
