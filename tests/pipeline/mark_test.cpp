#include <gtest/gtest.h>

#include "pipeline/mark/mark_session.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::sample_recording;
using testing::TemporaryFolder;

TEST(Mark, WritesBoxesIntoTheRecording) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  MarkSession session(folder / "a.h5", folder / "a.h5", false);
  const std::size_t frame = session.frames_of(session.recording().clips[1]).first + 2;
  session.save({{1, frame, {0, 0, 4, 4}, {3, 2, 5, 4}}});
  session.save({{0, 1, {1, 1, 2, 2}, {4, 4, 2, 2}}});
  const RecordingReader reader(folder / "a.h5");
  const auto& clips = reader.recording().clips;
  EXPECT_EQ(clips[1].box_frame, frame);
  EXPECT_EQ(clips[1].object_box.width, 5);
  EXPECT_EQ(clips[0].hand_box.x, 1);
  EXPECT_EQ(clips[0].object, "ball");
  EXPECT_EQ(reader.read_camera_frame(frame).color, sample_recording().frames[frame].color);
  EXPECT_EQ(session.state()["clips"][1]["object"], nlohmann::json({3, 2, 5, 4}));
}

TEST(Mark, RefusesImplausibleBoxes) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  MarkSession session(folder / "a.h5", folder / "b.h5", false);
  const auto expect_rejected = [&](const ClipBoxes& boxes, const std::string& text) {
    testing::expect_error([&] { session.save({boxes}); }, text, {});
  };
  const PixelBox good{1, 1, 2, 2};
  expect_rejected({0, 0, {5, 1, 4, 2}, good}, "leaves the image of 8 x 6");
  expect_rejected({0, 0, {3, 2, 8, 6}, good}, "did you write corners");
  expect_rejected({0, 0, {1, 1, 2147483647, 2}, good}, "leaves the image");
  expect_rejected({0, 0, good, {-1, 0, 3, 3}}, "leaves the image");
  expect_rejected({0, 0, good, {0, 0, 0, 3}}, "a box is empty");
  expect_rejected({0, 0, good, good}, "are the same");
  expect_rejected({0, 1000, good, {4, 4, 2, 2}}, "box_frame");
  expect_rejected({2, 0, good, {4, 4, 2, 2}}, "clip 2");
  EXPECT_FALSE(std::filesystem::exists(folder / "b.h5"));
  EXPECT_THROW(parse_box("1,2,3"), Error);
  EXPECT_THROW(parse_box("1,2,3,4.5"), Error);
  EXPECT_EQ(parse_box("1,2,3,4").height, 4);
}

}  // namespace
}  // namespace touchtrace
