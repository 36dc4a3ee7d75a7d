#include "pipeline/scene/simulate/simulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/camera_model.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace::scene {
namespace {

using testing::TemporaryFolder;

SceneOptions short_scene() {
  SceneOptions options;
  options.minutes = 0.1, options.clip_s = 3.0, options.clip_spread = 0.0, options.pause_s = 1.0;
  options.image_width = 160, options.image_height = 120;
  options.board_views = 2;
  return options;
}

Provenance provenance() { return start_provenance("touchtrace/recording/2", "simulate"); }

TEST(Simulate, SummaryMatchesTheRecording) {
  const SceneOptions options = short_scene();
  const TemporaryFolder folder;
  const auto path = folder / "whole.h5";
  Runtime runtime(choose_device(""));
  const auto summary = simulate_recording(options, &runtime, path, true, provenance());
  const RecordingReader reader(path);
  const Recording& recording = reader.recording();
  EXPECT_EQ(summary.clips, 2u);
  EXPECT_EQ(recording.clips.size(), summary.clips);
  EXPECT_EQ(recording.camera_times.frames(), summary.camera_frames);
  EXPECT_EQ(recording.gloves.front().frames(), summary.glove_frames);
  EXPECT_EQ(reader.board_views(), summary.board_views);
  EXPECT_NEAR(static_cast<double>(summary.camera_frames), 120.0, 8.0);
  EXPECT_GT(reader.read_camera_frame(summary.camera_frames - 1).color.size(), 0u);
}

/// Gravity by the accelerometer is within 1 degree, 3.5 standard deviations, of the truth.
TEST(Simulate, AccelerometerMeasuresGravity) {
  for (std::uint64_t seed : {1, 2, 3}) {
    SceneOptions options = short_scene();
    options.seed = seed;
    const RgbdCamera camera = make_camera(options);
    const Eigen::Vector3d measured = camera_info(camera, options).gravity_m_per_s2.value();
    const Eigen::Vector3d truth =
        camera.color_from_world.linear() * Eigen::Vector3d(0.0, 0.0, -gravity_m_per_s2);
    EXPECT_NEAR(measured.norm(), gravity_m_per_s2, 1e-5);  // stored as float
    EXPECT_GT(measured.normalized().dot(truth.normalized()), std::cos(1.0 / 57.29578));
  }
}

TEST(Simulate, BoxesAreCentredOnTheTrueObject) {
  const SceneOptions options = short_scene();
  const TemporaryFolder folder;
  const auto path = folder / "boxes.h5";
  Runtime runtime(choose_device(""));
  simulate_recording(options, &runtime, path, true, provenance());
  const Recording recording = RecordingReader(path).recording();
  const Truth truth = read_truth(path);
  const RgbdCamera camera = make_camera(options);
  const CameraClock clock = make_camera_clock(options);
  for (std::size_t c = 0; c < recording.clips.size(); ++c) {
    const Clip& clip = recording.clips[c];
    const auto first = std::ranges::find_if(
        recording.camera_times.sequence,
        [&](std::uint64_t sequence) { return clock.true_time_s(sequence) >= clip.start_s; });
    const auto sample = static_cast<std::size_t>(
        std::ranges::lower_bound(truth.time_s, clock.true_time_s(*first)) - truth.time_s.begin());
    const Eigen::Vector3d p(truth.object.position_m[3 * sample],
                            truth.object.position_m[3 * sample + 1],
                            truth.object.position_m[3 * sample + 2]);
    const Eigen::Vector2d pixel = camera.color.project(p);
    const PixelBox& box = clip.object_box;
    // Each side is off by up to 3 pixels, so the centre by up to 3; the object moves by less
    // than 1.
    EXPECT_NEAR(pixel.x(), box.x + 0.5 * box.width, 4.0);
    EXPECT_NEAR(pixel.y(), box.y + 0.5 * box.height, 4.0);
    EXPECT_FALSE(clip.hand_box.empty());
  }
}

TEST(Simulate, GloveAndTruthDoNotDependOnImages) {
  const SceneOptions options = short_scene();
  Runtime runtime(choose_device(""));
  const TemporaryFolder folder;
  const auto images = folder / "images.h5", glove = folder / "glove.h5";
  simulate_recording(options, &runtime, images, true, provenance());
  const auto summary = simulate_recording(options, nullptr, glove, true, provenance());
  EXPECT_EQ(summary.camera_frames, 0u);
  const Recording with = RecordingReader(images).recording();
  const Recording without = RecordingReader(glove).recording();
  EXPECT_EQ(with.gloves.front().counts, without.gloves.front().counts);
  EXPECT_EQ(with.gloves.front().host_time_s, without.gloves.front().host_time_s);
  EXPECT_EQ(read_truth(images).object.position_m, read_truth(glove).object.position_m);
}

ExitCode code_of(const SceneOptions& options, const std::filesystem::path& path, bool overwrite) {
  try {
    simulate_recording(options, nullptr, path, overwrite, provenance());
    return ExitCode::done;
  } catch (const Error& error) {
    return error.code();
  }
}

TEST(Simulate, RejectsUnknownNamesAndExistingOutputs) {
  const TemporaryFolder folder;
  const auto path = folder / "rejected.h5";
  SceneOptions options = short_scene();
  options.activity = "juggle";
  EXPECT_EQ(code_of(options, path, false), ExitCode::usage);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(code_of(short_scene(), path, false), ExitCode::done);
  EXPECT_NE(code_of(short_scene(), path, false), ExitCode::done);
}

}  // namespace
}  // namespace touchtrace::scene
