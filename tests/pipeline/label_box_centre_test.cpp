#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/label/states/lost_clips.h"
#include "pipeline/label/track/box_centre.h"

namespace touchtrace::label {
namespace {

constexpr double object_depth_m = 1.2, drawing_focal_px = 540.0;

Camera drawing_camera() {
  Camera result;
  result.width = 640, result.height = 480;
  result.fx = result.fy = drawing_focal_px, result.cx = 319.5, result.cy = 239.5;
  return result;
}

/// A clip whose object was found `offset_m` to the right of its box's centre.
ClipTrack found_beside(double offset_m) {
  ClipTrack track;
  track.object.resize(2);
  track.object.front().found = true;
  track.object.front().position_m = {offset_m, 0.0, object_depth_m};
  return track;
}

double sigma_of(const std::vector<ClipTrack>& tracks, const PixelBox& box = {300, 220, 40, 40}) {
  const ClipFrames clip{0, 2, {}, box, "foam"};
  return box_centre_sigma_m(drawing_camera(), "foam", std::vector<ClipFrames>(tracks.size(), clip),
                            tracks);
}

/// Standard deviation per axis of a two-dimensional offset, less the accuracy of drawing.
double expected_sigma_m(double offset_m) {
  constexpr double box_accuracy_rad = 0.015;
  return std::sqrt(0.5 * (offset_m * offset_m - std::pow(box_accuracy_rad * object_depth_m, 2)));
}

TEST(BoxCentre, SigmaIsTheOffsetOfBoxesFromTheFoundCentre) {
  EXPECT_NEAR(sigma_of({found_beside(0.05), found_beside(-0.04), found_beside(0.06)}),
              expected_sigma_m(0.05), 1e-12);
}

TEST(BoxCentre, OffsetsWithinDrawingAccuracyGiveZero) {
  EXPECT_EQ(sigma_of({found_beside(0.015), found_beside(-0.015)}), 0.0);
}

TEST(BoxCentre, IgnoresASingleWrongPose) {
  EXPECT_EQ(sigma_of({found_beside(0.0), found_beside(0.06), found_beside(0.0)}), 0.0);
}

TEST(BoxCentre, IgnoresClipsWhoseFirstFrameDoesNotShowTheObject) {
  auto carried = found_beside(0.05), lost = found_beside(0.05);
  carried.object.front().follows_hand = true;
  lost.object.front().found = false;
  EXPECT_EQ(sigma_of({carried, lost, ClipTrack()}), 0.0);
  EXPECT_NEAR(sigma_of({carried, lost, found_beside(0.05)}), expected_sigma_m(0.05), 1e-12);
}

TEST(BoxCentre, IgnoresBoxesAtTheImageBorder) {
  // the box's centre is 50 px to the right of the image's
  EXPECT_NEAR(sigma_of({found_beside(0.0)}, {220, 220, 300, 40}),
              expected_sigma_m(50.0 / drawing_focal_px * object_depth_m), 1e-12);
  EXPECT_EQ(sigma_of({found_beside(0.0)}, {220, 220, 420, 40}), 0.0);
}

TEST(BoxCentre, AnObjectFoundOutsideItsBoxIsLost) {
  const double half_width_m = 20.0 / drawing_focal_px * object_depth_m;
  std::vector tracks{found_beside(0.97 * half_width_m), found_beside(1.03 * half_width_m),
                     found_beside(1.03 * half_width_m), ClipTrack()};
  std::vector clips(tracks.size(), ClipFrames{0, 2, {}, {300, 220, 40, 40}, "bowl"});
  clips[2].has_mask_boxes = true;  // a mask's box does not contain what is hidden
  drop_objects_outside_boxes(drawing_camera(), clips, tracks);
  EXPECT_TRUE(tracks[0].object.front().found);
  EXPECT_FALSE(tracks[1].object.front().found);
  EXPECT_TRUE(tracks[2].object.front().found);
}

}  // namespace
}  // namespace touchtrace::label
