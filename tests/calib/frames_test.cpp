#include "calib/rig/frames.h"

#include <gtest/gtest.h>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

BoardObservations camera_with(const std::vector<std::string>& names) {
  BoardObservations camera;
  for (const auto& name : names) camera.views.push_back({name, {}, {}});
  return camera;
}

/// Names of the images of each frame, "-" where a camera has none.
std::vector<std::string> paired(const std::vector<BoardObservations>& cameras) {
  std::vector<std::vector<bool>> used;
  for (const auto& camera : cameras) used.emplace_back(camera.views.size(), true);
  std::vector<std::string> lines;
  for (const RigFrame& frame : pair_frames(cameras, used)) {
    std::string& line = lines.emplace_back();
    for (std::size_t i = 0; i < cameras.size(); ++i)
      line += (i ? " " : "") + (frame.views[i] ? cameras[i].views[*frame.views[i]].name : "-");
  }
  return lines;
}

using Lines = std::vector<std::string>;

TEST(Frames, ArePairedByTheirNumber) {
  EXPECT_EQ(paired({camera_with({"left01.jpg", "left02.jpg", "left10.jpg", "left11.jpg"}),
                    camera_with({"right1.png", "right2.png", "right3.png", "right11.png"})}),
            (Lines{"left01.jpg right1.png", "left02.jpg right2.png", "- right3.png", "left10.jpg -",
                   "left11.jpg right11.png"}));
  EXPECT_EQ(paired({camera_with({"1_cam0.png", "2_cam0.png", "3_cam0.png"}),
                    camera_with({"1_cam1.png", "2_cam1.png", "3_cam1.png"})}),
            (Lines{"1_cam0.png 1_cam1.png", "2_cam0.png 2_cam1.png", "3_cam0.png 3_cam1.png"}));
}

TEST(Frames, CommonDigitsBelongToTheNumber) {
  EXPECT_EQ(paired({camera_with({"l100.png", "l101.png", "l102.png"}),
                    camera_with({"r099.png", "r100.png", "r101.png", "r102.png"})}),
            (Lines{"- r099.png", "l100.png r100.png", "l101.png r101.png", "l102.png r102.png"}));
}

TEST(Frames, OfDifferentTimeStampsArePairedByOrder) {
  BoardObservations first = camera_with({"1.04.png", "1.36.png", "1.70.png"});
  first.views_without_board = {"1.20.png"};
  EXPECT_EQ(paired({first, camera_with({"1.05.png", "1.21.png", "1.37.png", "1.71.png"})}),
            (Lines{"1.04.png 1.05.png", "- 1.21.png", "1.36.png 1.37.png", "1.70.png 1.71.png"}));
}

TEST(Frames, WithoutAUsableViewAreLeftOut) {
  const std::vector<BoardObservations> cameras{camera_with({"1.png", "2.png", "3.png", "4.png"}),
                                               camera_with({"1.png", "2.png", "3.png", "4.png"})};
  const auto frames = pair_frames(cameras, {{true, false, true, true}, {true, false, true, true}});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1].name, "3.png");
}

TEST(Frames, RefuseEqualNames) {
  EXPECT_THROW(paired({camera_with({"1.png", "1.png"}), camera_with({"1.png", "2.png"})}), Error);
}

}  // namespace
}  // namespace touchtrace
