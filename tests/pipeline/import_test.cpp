#include "pipeline/acquire/import/import.h"

#include <gtest/gtest.h>

#include "pipeline/export/zip_writer.h"
#include "tests/pipeline/import_samples.h"
#include "tests/support/bag_writer.h"

namespace touchtrace {
namespace {

TEST_F(Import, ReadsTumFolders) {
  write_import_tum(folder_ / "tum");
  ImportOptions options;
  options.camera.gravity_m_per_s2 = {0.0, 9.81, 0.0};
  options.background_frames = "1:2";
  options.object = "ball";
  const RecordingReader reader = import("tum", options);
  expect_samples(reader, 5000);
  const Recording& r = reader.recording();
  EXPECT_NEAR(r.epoch_unix_s, import_start_s, 1e-6);
  EXPECT_NEAR(r.camera_times.host_time_s[0], 0.004, 1e-6);
  EXPECT_TRUE(r.camera.is_registered);
  ASSERT_TRUE(r.camera.color_camera.has_value());
  EXPECT_EQ(r.camera.color_camera->fx, 7.0);
  EXPECT_EQ(r.camera.gravity_m_per_s2->y(), 9.81);
  EXPECT_EQ(r.clips[0].object, "ball");
  EXPECT_EQ(reader.background_frames(), 2u);
  EXPECT_EQ(reader.read_background(1).color[3], 102);
}

TEST_F(Import, ReadsTumStampsOfOtherUnits) {
  for (const double start_s : {import_start_s, 2.5})
    for (const double per_second : {1e3, 1e6, 1e9}) {
      SCOPED_TRACE(fmt::format("{:g} {:g}", start_s, per_second));
      write_import_tum(folder_ / "tum", 5000, per_second, start_s);
      const RecordingReader reader = import("tum");
      expect_samples(reader, 5000);
      EXPECT_NEAR(reader.recording().camera.rate_hz, 30.0, 0.01);
    }
}

TEST_F(Import, ProposesAnotherScaleForMillimetres) {
  write_import_tum(folder_ / "tum", 1001);
  expect_rejected("tum", "the depth may be in millimetres");
  write_import_tum(folder_ / "tum", 400);
  expect_rejected("tum", "1000 (median 0.40 m)");
  write_import_tum(folder_ / "tum", 1000);
  ImportOptions options;
  options.camera.depth_scale = 1000;
  expect_samples(import("tum", options), 1000);
  options.camera.depth_scale = 0.001;  // metres per count
  expect_rejected("tum", "1000 (median 1.00 m)", options);
}

TEST_F(Import, LeavesOutDamagedImages) {
  write_import_tum(folder_ / "tum");
  add_file("tum/rgb/1.png", "damaged");
  add_file("tum/depth/2.png", encoded(import_color(0)));
  const RecordingReader reader = import("tum");
  EXPECT_EQ(summary_["skipped"], 2);
  EXPECT_EQ(reader.color_images(), 3u);
  EXPECT_EQ(reader.depth_images(), 3u);
  EXPECT_EQ(reader.read_camera_frame(0).color[3], 100);
  for (const char* name : {"0.png", "2.png"}) write_file(folder_ / "tum" / "rgb" / name, "", true);
  expect_rejected("tum", "3 of 4 colour images");
}

TEST_F(Import, WarnsOfRepeatedImages) {
  write_import_tum(folder_ / "tum");
  import("tum");
  EXPECT_FALSE(warns_of("equal the one before")) << warnings_;
  add_file("tum/rgb/2.png", encoded(import_color(1)));
  import("tum");
  EXPECT_TRUE(warns_of("1 of 4 colour images equal the one before")) << warnings_;
}

TEST_F(Import, ReadsFoldersWithNumbersAndMasks) {
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = fmt::format("frame_{}.png", i + 8);  // 8, 9, 10, 11
    add_file("in/color/" + name, encoded(import_color(i)));
    add_file("in/depth/" + name, encoded(import_depth(i, 1000)));
  }
  cv::Mat ids(import_height, import_width, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(0, 2) = 7, ids.at<std::uint8_t>(0, 3) = 2;
  add_file("masks/frame_9.png", encoded(ids));
  cv::Mat palette(import_height, import_width, CV_8UC3, cv::Scalar(0, 0, 0));
  palette.at<cv::Vec3b>(0, 2) = {128, 128, 128}, palette.at<cv::Vec3b>(0, 3) = {0, 128, 0};
  add_file("masks/frame_10.png", encoded(palette));
  add_file("in/intrinsics.txt", "7 0 4\n0 7 3\n0 0 1\n");
  expect_rejected("in", "--rate");
  ImportOptions options = at_rate(30.0);
  options.masks = (folder_ / "masks").string();
  options.mask_ids.hand = 7;
  const RecordingReader reader = import("in", options);
  expect_samples(reader, 1000);
  EXPECT_TRUE(reader.recording().camera.is_registered);
  EXPECT_EQ(reader.recording().camera.color_camera->cy, 3.0);
  EXPECT_TRUE(reader.read_camera_frame(0).mask.empty());
  for (int i : {1, 2}) {
    const auto mask = reader.read_camera_frame(i).mask;
    ASSERT_EQ(mask.size(), std::size_t(import_width * import_height));
    EXPECT_EQ(mask[1], mask_other);
    EXPECT_EQ(mask[2], mask_hand);
    EXPECT_EQ(mask[3], mask_object);
  }
}

TEST_F(Import, ReadsTimesFromNamesAndLists) {
  std::string times = "time_ms\n";
  for (int i = 0; i < import_frames; ++i) {
    const auto stamp_ns = 1700000000250000000 + i * 33333333ll;
    add_file(fmt::format("in/rgb/{}.png", stamp_ns), encoded(import_color(i)));
    add_file(fmt::format("in/depth/{}.png", i), encoded(import_depth(i, 1000)));
    times += fmt::format("{:.3f}\n", 1e3 * import_start_s + i * 33.333);
  }
  add_file("in/depth/times.csv", times);
  add_file("clips.csv", "start_s,end_s,object\n0.02,0.09,ball\n");
  expect_samples(import("in"), 1000);
  ImportOptions options;
  options.clips = (folder_ / "clips.csv").string();
  const Recording clipped = import("in", options).recording();
  EXPECT_NEAR(clipped.epoch_unix_s, import_start_s, 1e-6);
  EXPECT_EQ(clipped.clips.at(0).object, "ball");
  EXPECT_EQ(clipped.clips[0].end_s, 0.09);
  add_file("in/depth/times.csv", "1.0\n2.0\n");
  expect_rejected("in", "2 times");
  add_file("in/depth/times.csv", times);
  add_file("clips.csv", "3,4\n");
  expect_rejected("in", "outside the recording", options);
  add_file("clips.csv", "start_s,end_s,object\n");
  expect_rejected("in", "has no clips", options);
  add_file("clips.csv", "start_s,end_s,object\n0.02,0.09,\n");
  EXPECT_EQ(import("in", options).recording().clips.at(0).object, "object");
}

/// .npy file of version 1.
std::string npy(const std::string& type, const std::string& shape, const std::string& data) {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize(118, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + data;
}

/// Writes images with floating-point depth.
void write_depth_arrays(const std::filesystem::path& folder, double units_per_m) {
  for (int i = 0; i < import_frames; ++i) {
    cv::Mat depth;
    import_depth(i, 4000).convertTo(depth, CV_32F, units_per_m / 4000.0);
    const std::string name = fmt::format("{:.6f}", import_start_s + i / 30.0);
    write_file(folder / "rgb" / (name + ".png"), encoded(import_color(i)), true);
    write_file(folder / "depth" / (name + ".npy"), npy("<f4", "(6, 8)", pixels(depth)), true);
  }
}

TEST_F(Import, ReadsDepthArrays) {
  write_depth_arrays(folder_ / "in", 1.0);
  expect_samples(import("in"), 4000);
}

TEST_F(Import, RefusesDepthArraysInMillimetresUnlessTold) {
  write_depth_arrays(folder_ / "in", 1000.0);
  expect_rejected("in", "in metres the median depth would be 1000 m", {});
  ImportOptions options;
  options.camera.depth_scale = 1000.0;
  expect_samples(import("in", options), 4000);
}

/// Archive of stored files.
std::string zip(const std::vector<std::pair<std::string, std::string>>& files) {
  const TemporaryFolder folder;
  ZipWriter writer(folder / "a.zip");
  for (const auto& [name, data] : files) writer.add(name, data);
  writer.finish();
  return read_file(folder / "a.zip");
}

TEST_F(Import, DepthOfAnArchiveIsItsOnlyImage) {
  write_depth_arrays(folder_ / "in", 1.0);
  const fs::path depth = folder_ / "in" / "depth";
  std::vector<fs::path> files(fs::directory_iterator(depth), {});
  for (const fs::path& file : files) {
    const std::string scale = npy("<f8", "()", std::string(8, '\0'));
    write_file(fs::path(file).replace_extension(".npz"),
               zip({{"scale.npy", scale}, {"note.npy", "text"}, {"data.npy", read_file(file)}}),
               true);
    fs::remove(file);
  }
  expect_samples(import("in"), 4000);
}

TEST_F(Import, ReadsNumpyArchives) {
  std::string color, depth, time_s;
  for (int i = 0; i < import_frames; ++i) {
    cv::Mat rgb;
    cv::cvtColor(import_color(i), rgb, cv::COLOR_BGR2RGB);
    color += pixels(rgb), depth += pixels(import_depth(i, 1000));
    time_s += testing::bytes_of_number(5.0 + i / 30.0);
  }
  const std::string good = zip({{"color.npy", npy("|u1", "(4, 6, 8, 3)", color)},
                                {"depth.npy", npy("<u2", "(4, 6, 8)", depth)},
                                {"time_s.npy", npy("<f8", "(4,)", time_s)}});
  add_file("in.npz", good);
  expect_samples(import("in.npz"), 1000);
  expect_damage_survived("in.npz", good, 200);
}

TEST_F(Import, RejectsWhatIsNotASource) {
  expect_rejected("missing", "does not exist");
  add_file("empty/readme.txt", "nothing");
  expect_rejected("empty", "give one of: TUM RGB-D folder");
  add_file("bad.npz", "PK\5\6");
  expect_rejected("bad.npz", "cannot read");
  write_import_tum(folder_ / "tum");
  write_file(folder_ / "tum" / "camera_info.yaml",
             "height: 480\nwidth: 640\nK: [7.0, 0.0, 4.0, 0.0, 7.0, 3.0, 0.0, 0.0, 1.0]\n", true);
  expect_rejected("tum", "640x480");
}

}  // namespace
}  // namespace touchtrace
