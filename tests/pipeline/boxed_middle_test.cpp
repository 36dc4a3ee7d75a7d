#include "pipeline/label/boxed_middle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchtrace::label {
namespace {

constexpr double put_at_m = 1.2, put_focal_px = 540.0;

Camera drawing_camera() {
  Camera result;
  result.width = 640, result.height = 480;
  result.fx = result.fy = put_focal_px, result.cx = 319.5, result.cy = 239.5;
  return result;
}

/// A clip whose object was put so far right of the middle of its box.
ClipTrack put_beside(double off_m) {
  ClipTrack track;
  track.object.resize(2);
  track.object.front().found = true;
  track.object.front().position_m = {off_m, 0.0, put_at_m};
  return track;
}

double boxed_sigma_m(const std::vector<ClipTrack>& tracks,
                     const PixelBox& box = {300, 220, 40, 40}) {
  const ClipFrames clip{0, 2, {}, box, "foam"};
  return boxed_middle_sigma_m(drawing_camera(), "foam",
                              std::vector<ClipFrames>(tracks.size(), clip), tracks);
}

TEST(LabelBoxedMiddle, WhatTheHandHidesIsToldByTheBoxes) {
  EXPECT_NEAR(boxed_sigma_m({put_beside(0.05), put_beside(-0.04), put_beside(0.06)}),
              0.05 / std::sqrt(2.0), 0.003);
}

TEST(LabelBoxedMiddle, ABoxIsNoMoreAccurateThanAHandDrawsIt) {
  EXPECT_EQ(boxed_sigma_m({put_beside(0.015), put_beside(-0.015)}), 0.0);
}

TEST(LabelBoxedMiddle, OneWrongPoseDoesNotCount) {
  EXPECT_EQ(boxed_sigma_m({put_beside(0.0), put_beside(0.06), put_beside(0.0)}), 0.0);
}

TEST(LabelBoxedMiddle, WhereTheFirstFrameDoesNotShowTheObjectItTellsNothing) {
  auto carried = put_beside(0.05), lost = put_beside(0.05);
  carried.object.front().follows_hand = true;
  lost.object.front().found = false;
  EXPECT_EQ(boxed_sigma_m({carried, lost, ClipTrack()}), 0.0);
  EXPECT_GT(boxed_sigma_m({carried, lost, put_beside(0.05)}), 0.03);
}

TEST(LabelBoxedMiddle, TheMiddleOfABoxThatThePictureCutsOffIsNotTheObjects) {
  EXPECT_GT(boxed_sigma_m({put_beside(0.0)}, {220, 220, 300, 40}), 0.05);
  EXPECT_EQ(boxed_sigma_m({put_beside(0.0)}, {220, 220, 420, 40}), 0.0);
}

}  // namespace
}  // namespace touchtrace::label
