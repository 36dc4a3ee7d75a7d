#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/error.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::sample_recording;
using testing::TemporaryFolder;

/// Writes a.h5 in the folder with Python code of a user of h5py.
std::filesystem::path written_by(const TemporaryFolder& folder, const std::string& python) {
  testing::expect_python(folder.path(),
                         "file = h5py.File('a.h5', 'w')\n" + python + "\nfile.close()");
  return folder / "a.h5";
}

constexpr const char* minimal = R"(
file.attrs['schema'] = 'touchtrace/recording/2'
file['color/host_time_s'] = np.arange(10) / 30
file['color/image'] = np.arange(10 * 4 * 6 * 3).reshape(10, 4, 6, 3) % 256
)";

TEST(RecordingPython, DefaultsFillWhatIsMissing) {
  const TemporaryFolder folder;
  const RecordingReader reader(written_by(folder, minimal));
  const Recording& r = reader.recording();
  EXPECT_EQ(r.activity, "");
  EXPECT_EQ(r.camera.width, 6);
  EXPECT_NEAR(r.camera.rate_hz, 30.0, 1e-9);
  EXPECT_FALSE(reader.has_depth());
  ASSERT_EQ(r.camera_times.frames(), 10u);
  EXPECT_EQ(r.camera_times.device_time_s, r.camera_times.host_time_s);
  EXPECT_EQ(r.camera_times.sequence[9], 9u);
  ASSERT_EQ(r.clips.size(), 1u);
  EXPECT_EQ(r.clips[0].object, "object");
  EXPECT_EQ(r.clips[0].start_s, 0.0);
  EXPECT_GT(r.clips[0].end_s, 0.3);
  EXPECT_EQ(reader.read_camera_frame(1).color[1], 73);
}

TEST(RecordingPython, GloveDefaults) {
  const TemporaryFolder folder;
  const auto path = written_by(folder, std::string(minimal) + R"(
file['glove0/host_time_s'] = np.arange(30, dtype='f4') / 10
file['glove0/counts'] = np.full((30, 3, 2), 40000.0)
file['clips/object'] = ['cup', 'longer name']
file['clips/start_s'] = [0.0, 1.0]
file['clips/end_s'] = [1, 2]
)");
  const RecordingReader reader(path);
  const GloveStream& glove = reader.recording().gloves.at(0);
  EXPECT_EQ(glove.info.rows, 3);
  EXPECT_EQ(glove.info.cols, 2);
  EXPECT_EQ(glove.info.bits, 16);
  EXPECT_EQ(glove.info.polarity, 1);
  EXPECT_NEAR(glove.info.rate_hz, 10.0, 1e-4);
  EXPECT_EQ(glove.info.baseline_counts, std::vector<float>(6, 0.0f));
  EXPECT_EQ(glove.info.mask, std::vector<std::uint8_t>(6, 1));
  EXPECT_TRUE(std::isnan(glove.info.taxel_position_m.at(17)));
  EXPECT_EQ(glove.counts.at(7), 40000);
  EXPECT_EQ(glove.sequence.at(29), 29u);
  EXPECT_EQ(reader.recording().clips[1].object, "longer name");
  EXPECT_TRUE(reader.recording().clips[1].hand_box.empty());
}

TEST(RecordingPython, FloatDepthIsInMetres) {
  const TemporaryFolder folder;
  const auto path = written_by(folder, std::string(minimal) + R"(
depth = np.full((10, 2, 3), 1.5, 'f4')
depth[:, 0, 0], depth[:, 0, 1], depth[:, 0, 2] = np.nan, -1, 100
file['depth/image'], file['depth/host_time_s'] = depth, np.arange(10) / 30
)");
  const RecordingReader reader(path);
  const CameraInfo& camera = reader.recording().camera;
  EXPECT_EQ(camera.depth_image_width(), 3);
  const auto depth = reader.read_camera_frame(4).depth;
  EXPECT_EQ(std::vector<std::uint16_t>(depth.begin(), depth.begin() + 3),
            std::vector<std::uint16_t>(3, 0));
  EXPECT_NEAR(depth[3] * camera.depth_unit_m, 1.5, 1e-6);
}

TEST(RecordingPython, AttributesMayBeTextOrArraysOrJson) {
  const TemporaryFolder folder;
  const auto path = written_by(folder, std::string(minimal) + R"(
color = file['color'].attrs
color['intrinsics'] = '[5, 5.5, 2.5, 1.5]'
color['distortion_model'], color['distortion'] = 'plumb_bob', np.array([.1, .2, 0, 0, .3], 'f4')
color['gravity'] = np.array([[0, 9.8, 0]])
file.attrs['epoch_unix_s'] = 5
file.attrs['provenance'] = json.dumps({'command': 'my script'})
file['masks/image'] = np.full((1, 4, 6), 7)
file['masks'].attrs['object'], file['masks'].attrs['hand'] = [7, 9], 3
file['masks/color_frame'] = [8]
file['depth/image'] = np.full((10, 4, 6), 1000)
file['depth/host_time_s'] = np.arange(10) / 30
file['depth'].attrs['depth_unit_m'], file['depth'].attrs['registered'] = np.float32(0.001), True
file['depth'].attrs['depth_from_color'] = np.eye(4).tolist()
)");
  const RecordingReader reader(path);
  const Recording& r = reader.recording();
  ASSERT_TRUE(r.camera.color_camera.has_value());
  EXPECT_EQ(r.camera.color_camera->fy, 5.5);
  EXPECT_EQ(lens_name(r.camera.color_camera->lens), "radtan5");
  EXPECT_NEAR(r.camera.color_camera->distortion[4], 0.3, 1e-6);
  EXPECT_EQ(r.camera.gravity_m_per_s2->y(), 9.8);
  EXPECT_EQ(r.epoch_unix_s, 5.0);
  EXPECT_EQ(r.provenance.command, "my script");
  EXPECT_TRUE(r.camera.is_registered);
  EXPECT_TRUE(r.camera.depth_from_color->isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(reader.read_camera_frame(8).mask, std::vector<std::uint8_t>(24, mask_object));
  EXPECT_TRUE(reader.read_camera_frame(7).mask.empty());
}

TEST(RecordingPython, RewritingKeepsTheFilesClockAndWhatTouchtraceDoesNotKnow) {
  const TemporaryFolder folder;
  const auto path = written_by(folder, std::string(minimal) + R"(
file['color/host_time_s'][:] += 1.7e9
file['notes'] = 'mine'
)");
  auto clips = RecordingReader(path).recording().clips;
  clips[0].hand_box = {1, 1, 2, 2}, clips[0].end_s = 0.2;
  rewrite_clips(path, path, clips, {{3, std::vector<std::uint8_t>(24, mask_hand)}}, true);
  const RecordingReader reader(path);
  EXPECT_EQ(reader.recording().epoch_unix_s, 1.7e9);
  EXPECT_NEAR(reader.recording().clips[0].end_s, 0.2, 1e-6);
  EXPECT_EQ(reader.recording().clips[0].hand_box.width, 2);
  EXPECT_EQ(reader.read_camera_frame(3).mask.at(23), mask_hand);
  testing::expect_python(folder.path(),
                         "f = h5py.File('a.h5')\nassert f['notes'][()] == b'mine'\n"
                         "assert f['clips/start_s'][0] == 1.7e9");
}

/// Moves today's groups to where schema 1 had them.
constexpr const char* to_schema_1 = R"(
file.attrs['schema'] = np.bytes_('touchtrace/recording/1')
camera = file.create_group('camera')
for name in 'host_time_s', 'device_time_s', 'sequence':
    file.move('color/' + name, 'camera/' + name)
file.move('color/image', 'camera/color')
file.move('depth/image', 'camera/depth')
camera.attrs['width'], camera.attrs['height'], camera.attrs['rate_hz'] = 8, 6, 20.0
camera.attrs['depth_unit_m'] = file['depth'].attrs['depth_unit_m']
camera['gravity'] = file['color'].attrs['gravity']
camera['depth_intrinsics'] = file['depth'].attrs['intrinsics']
del file['color'], file['depth'], file['masks'], file['clips/box_frame']
)";

TEST(RecordingPython, SchemaOneIsReadAndRewritten) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  testing::expect_python(folder.path(),
                         std::string("file = h5py.File('a.h5', 'r+')\n") + to_schema_1);
  rewrite_clips(folder / "a.h5", folder / "b.h5", sample.recording.clips,
                {{2, sample.frames[2].mask}}, false);
  for (const char* name : {"a.h5", "b.h5"}) {
    const RecordingReader reader(folder / name);
    const Recording& r = reader.recording();
    EXPECT_EQ(r.camera_times.host_time_s, sample.recording.camera_times.host_time_s);
    EXPECT_EQ(r.camera_times.device_time_s, sample.recording.camera_times.device_time_s);
    EXPECT_EQ(r.camera.gravity_m_per_s2, sample.recording.camera.gravity_m_per_s2);
    EXPECT_EQ(r.camera.depth_camera->parameters(),
              sample.recording.camera.depth_camera->parameters());
    EXPECT_EQ(r.gloves.at(0).counts, sample.recording.gloves[0].counts);
    EXPECT_EQ(reader.read_camera_frame(53).depth, sample.frames[53].depth);
    EXPECT_EQ(reader.read_board_view(1).color, sample.board[1].color);
    EXPECT_EQ(read_truth(folder / name).time_s, sample.truth.time_s);
  }
  EXPECT_EQ(RecordingReader(folder / "b.h5").read_camera_frame(2).mask, sample.frames[2].mask);
}

}  // namespace
}  // namespace touchtrace
