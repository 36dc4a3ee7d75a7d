#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "pipeline/recording/frame_pairs.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::sample_recording;
using testing::TemporaryFolder;

constexpr int width = 8, height = 6, depth_width = 5, depth_height = 4;

std::vector<std::uint8_t> color_image(std::size_t i) {
  return std::vector<std::uint8_t>(3 * width * height, static_cast<std::uint8_t>(i));
}

std::vector<std::uint16_t> depth_image(std::size_t i) {
  return std::vector<std::uint16_t>(depth_width * depth_height, static_cast<std::uint16_t>(i));
}

CameraTimes times(int frames, double first_s, double rate_hz) {
  CameraTimes result;
  for (int i = 0; i < frames; ++i) {
    result.sequence.push_back(100u + static_cast<unsigned>(i));
    result.host_time_s.push_back(first_s + i / rate_hz);
    result.device_time_s.push_back(7.0 + i / rate_hz);
  }
  return result;
}

/// 2 s of colour at 30 Hz and depth at 15 Hz, 5 ms later.
Recording two_rates() {
  Recording recording;
  CameraInfo& camera = recording.camera;
  camera.width = width, camera.height = height;
  camera.depth_width = depth_width, camera.depth_height = depth_height;
  camera.rate_hz = 15.0;
  camera.color_camera = Camera{width, height, 7.0, 7.5, 3.5, 2.5, Rational8{}};
  camera.color_camera->distortion << 0.1, 0.2, 0.001, 0.002, 0.3, 0.4, 0.5, 0.6;
  camera.depth_camera = Camera{depth_width, depth_height, 5.0, 5.5, 2.0, 1.5, Fisheye4{}};
  camera.depth_camera->distortion.head<4>() << 0.1, 0.2, 0.3, 0.4;
  camera.depth_from_color = Eigen::Isometry3d(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  camera.depth_from_color->translation() << 0.05, 0.0, 0.01;
  recording.color_times = times(60, 10.0, 30.0);
  recording.camera_times = times(30, 10.005, 15.0);
  recording.clips = {{10.0, 12.0, "ball", false, {0, 0, 2, 2}, {3, 3, 2, 2}, 20}};
  return recording;
}

void write(const Recording& recording, const std::filesystem::path& path) {
  RecordingWriter writer(path, recording.camera, false);
  for (std::size_t i = 0; i < recording.color_times.frames(); ++i)
    writer.append_color(color_image(i));
  for (std::size_t i = 0; i < recording.camera_times.frames(); ++i)
    writer.append_depth(depth_image(i));
  writer.append_mask(20, std::vector<std::uint8_t>(width * height, mask_object));
  writer.finish(recording);
}

void expect_same(const Camera& a, const Camera& b) {
  EXPECT_EQ(a.parameters(), b.parameters());
  EXPECT_EQ(lens_name(a.lens), lens_name(b.lens));
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
}

TEST(RecordingStreams, PairImagesOfDifferentSizeAndRate) {
  const TemporaryFolder folder;
  const Recording written = two_rates();
  write(written, folder / "a.h5");
  const RecordingReader reader(folder / "a.h5");
  const Recording& read = reader.recording();
  EXPECT_EQ(reader.color_images(), 60u);
  EXPECT_EQ(reader.depth_images(), 30u);
  EXPECT_EQ(read.camera_times.host_time_s, written.camera_times.host_time_s);
  EXPECT_EQ(read.camera_times.device_time_s, written.camera_times.device_time_s);
  EXPECT_EQ(read.camera_times.sequence, written.camera_times.sequence);
  EXPECT_EQ(read.camera.rate_hz, 15.0);
  EXPECT_EQ(read.clips[0].box_frame, 10u);
  expect_same(*read.camera.color_camera, *written.camera.color_camera);
  expect_same(*read.camera.depth_camera, *written.camera.depth_camera);
  EXPECT_TRUE(read.camera.depth_from_color->isApprox(*written.camera.depth_from_color));
  EXPECT_FALSE(read.camera.is_registered);
  for (std::size_t i = 0; i < 30; ++i) {
    const RgbdFrame frame = reader.read_camera_frame(i);
    EXPECT_EQ(frame.color, color_image(2 * i));
    EXPECT_EQ(frame.depth, depth_image(i));
    EXPECT_EQ(frame.mask, i == 10 ? std::vector<std::uint8_t>(width * height, mask_object)
                                  : std::vector<std::uint8_t>{});
  }
}

TEST(RecordingStreams, RegisteredDepthHasTheColourImagesSize) {
  const TemporaryFolder folder;
  Recording recording = two_rates();
  recording.camera.is_registered = true;
  write(recording, folder / "a.h5");
  EXPECT_THROW(RecordingReader(folder / "a.h5"), Error);
}

TEST(RecordingStreams, PairsAreNearestWithinHalfOfTheSlowerInterval) {
  const auto colors_of = [](const std::vector<double>& color_s,
                            const std::vector<double>& depth_s) {
    std::vector<std::size_t> colors;
    for (const auto& pair : pair_frames(color_s, depth_s)) colors.push_back(pair.color);
    return colors;
  };
  using Indices = std::vector<std::size_t>;
  EXPECT_EQ(colors_of({0.0, 1.0, 2.0}, {0.1, 0.4, 0.6, 1.9}), (Indices{0, 0, 1, 2}));
  EXPECT_EQ(colors_of({0.0, 1.0, 2.0, 9.0}, {0.0, 2.4, 2.6, 7.0}), (Indices{0, 2, 2}));
  EXPECT_EQ(colors_of({1.0, 1.0, 2.0}, {1.0, 1.0, 2.0}), (Indices{0, 1, 2}));
  EXPECT_EQ(colors_of({5.0}, {}), Indices{});
  EXPECT_EQ(colors_of({}, {5.0}), Indices{});
}

TEST(RecordingStreams, UnixStampsAreShifted) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  Recording& recording = sample.recording;
  recording.epoch_unix_s = 0.0;
  const auto shift = [](std::vector<double>& time_s) {
    for (double& t : time_s) t += 1.75e9;
  };
  shift(recording.gloves[0].host_time_s), shift(recording.camera_times.host_time_s);
  shift(sample.truth.time_s);
  for (auto& clip : recording.clips) clip.start_s += 1.75e9, clip.end_s += 1.75e9;
  write(sample, folder / "a.h5");
  const RecordingReader reader(folder / "a.h5");
  const Recording& read = reader.recording();
  EXPECT_EQ(read.epoch_unix_s, recording.camera_times.host_time_s[0]);
  EXPECT_EQ(read.camera_times.host_time_s[0], 0.0);
  EXPECT_NEAR(read.clips[1].start_s, recording.clips[1].start_s - read.epoch_unix_s, 1e-6);
  EXPECT_NEAR(read_truth(folder / "a.h5").time_s[1], 0.01, 1e-6);
}

class RewriteClips : public ::testing::Test {
 protected:
  void SetUp() override { testing::write(sample, path); }

  const TemporaryFolder folder;
  const testing::SampleRecording sample = sample_recording();
  const std::filesystem::path path = folder / "a.h5";
};

TEST_F(RewriteClips, KeepsEverythingElse) {
  std::vector<Clip> clips = sample.recording.clips;
  clips[1].object_box = {0, 0, 4, 4}, clips[1].box_frame = 30;
  const std::vector<std::uint8_t> mask(48, mask_hand);
  rewrite_clips(path, path, clips, {{30, mask}}, true);
  const RecordingReader reader(path);
  EXPECT_EQ(reader.recording().clips[1].box_frame, 30u);
  EXPECT_EQ(reader.recording().clips[1].object_box.width, 4);
  EXPECT_EQ(reader.recording().gloves[0].counts, sample.recording.gloves[0].counts);
  EXPECT_EQ(reader.masked_color_images(), (std::vector<std::size_t>{2, 30}));
  EXPECT_EQ(reader.read_camera_frame(2).mask, sample.frames[2].mask);
  EXPECT_EQ(reader.read_camera_frame(30).mask, mask);
  EXPECT_EQ(reader.read_camera_frame(53).color, sample.frames[53].color);
  EXPECT_EQ(read_truth(path).time_s, sample.truth.time_s);
}

TEST_F(RewriteClips, ReplacesFilesOnlyOnRequest) {
  testing::put(folder / "b.h5", "precious");
  EXPECT_THROW(rewrite_clips(path, folder / "b.h5", {}, {}, false), Error);
  EXPECT_NO_THROW(rewrite_clips(path, folder / "b.h5", {}, {}, true));
  EXPECT_TRUE(RecordingReader(folder / "b.h5").recording().clips.empty());
  EXPECT_EQ(RecordingReader(path).recording().clips.size(), 2u);
}

TEST_F(RewriteClips, RejectsMasksOfAnotherSizeAndKeepsTheFile) {
  EXPECT_THROW(rewrite_clips(path, path, {}, {{1, {1, 2, 3}}}, true), Error);
  EXPECT_EQ(RecordingReader(path).recording().clips.size(), 2u);
}

}  // namespace
}  // namespace touchtrace
