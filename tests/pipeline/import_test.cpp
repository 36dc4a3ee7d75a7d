#include "pipeline/acquire/import/import.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"
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
  fs::remove(folder_ / "out.h5");
  expect_rejected("tum", "1000 (median 1.00 m)", options);
}

TEST_F(Import, LeavesOutDamagedImages) {
  write_import_tum(folder_ / "tum");
  write_file(folder_ / "tum" / "rgb" / "1.png", "damaged", true);
  write_file(folder_ / "tum" / "depth" / "2.png", encoded(import_color(0)), true);
  const RecordingReader reader = import("tum");
  EXPECT_EQ(summary_["skipped"], 2);
  EXPECT_EQ(reader.color_images(), 3u);
  EXPECT_EQ(reader.depth_images(), 3u);
  EXPECT_EQ(reader.read_camera_frame(0).color[3], 100);
  for (const char* name : {"0.png", "2.png"}) write_file(folder_ / "tum" / "rgb" / name, "", true);
  fs::remove(folder_ / "out.h5");
  expect_rejected("tum", "3 of 4 colour images");
}

TEST_F(Import, WarnsOfRepeatedImages) {
  write_import_tum(folder_ / "tum");
  const auto warnings = [&] {
    fs::remove(folder_ / "out.h5");
    ::testing::internal::CaptureStderr();
    import("tum");
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings().find("equal the one before"), std::string::npos);
  write_file(folder_ / "tum" / "rgb" / "2.png", encoded(import_color(1)), true);
  EXPECT_NE(warnings().find("1 of 4 colour images equal the one before"), std::string::npos);
}

TEST_F(Import, ReadsFoldersWithNumbersAndMasks) {
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = fmt::format("frame_{}.png", i + 8);  // 8, 9, 10, 11
    write_file(folder_ / "in" / "color" / name, encoded(import_color(i)), true);
    write_file(folder_ / "in" / "depth" / name, encoded(import_depth(i, 1000)), true);
  }
  cv::Mat ids(import_height, import_width, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(0, 2) = 7, ids.at<std::uint8_t>(0, 3) = 2;
  write_file(folder_ / "masks" / "frame_9.png", encoded(ids), true);
  cv::Mat palette(import_height, import_width, CV_8UC3, cv::Scalar(0, 0, 0));
  palette.at<cv::Vec3b>(0, 2) = {128, 128, 128}, palette.at<cv::Vec3b>(0, 3) = {0, 128, 0};
  write_file(folder_ / "masks" / "frame_10.png", encoded(palette), true);
  write_file(folder_ / "in" / "intrinsics.txt", "7 0 4\n0 7 3\n0 0 1\n", true);
  expect_rejected("in", "--rate");
  ImportOptions options;
  options.source.rate_hz = 30.0;
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
    write_file(folder_ / "in" / "rgb" / fmt::format("{}.png", stamp_ns), encoded(import_color(i)),
               true);
    write_file(folder_ / "in" / "depth" / fmt::format("{}.png", i), encoded(import_depth(i, 1000)),
               true);
    times += fmt::format("{:.3f}\n", 1e3 * import_start_s + i * 33.333);
  }
  write_file(folder_ / "in" / "depth" / "times.csv", times, true);
  write_file(folder_ / "clips.csv", "start_s,end_s,object\n0.02,0.09,ball\n", true);
  expect_samples(import("in"), 1000);
  ImportOptions options;
  options.clips = (folder_ / "clips.csv").string();
  const Recording clipped = import("in", options).recording();
  EXPECT_NEAR(clipped.epoch_unix_s, import_start_s, 1e-6);
  EXPECT_EQ(clipped.clips.at(0).object, "ball");
  EXPECT_EQ(clipped.clips[0].end_s, 0.09);
  fs::remove(folder_ / "out.h5");
  write_file(folder_ / "in" / "depth" / "times.csv", "1.0\n2.0\n", true);
  expect_rejected("in", "2 times");
  write_file(folder_ / "in" / "depth" / "times.csv", times, true);
  write_file(folder_ / "clips.csv", "3,4\n", true);
  expect_rejected("in", "outside the recording", options);
  write_file(folder_ / "clips.csv", "start_s,end_s,object\n", true);
  expect_rejected("in", "has no clips", options);
  write_file(folder_ / "clips.csv", "start_s,end_s,object\n0.02,0.09,\n", true);
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
  using testing::bytes_of_number;
  const std::string zeros(12, '\0');
  std::string archive, directory;
  for (const auto& [name, data] : files) {
    const auto size = bytes_of_number(static_cast<std::uint32_t>(data.size())),
               offset = bytes_of_number(static_cast<std::uint32_t>(archive.size())),
               name_size = bytes_of_number(static_cast<std::uint16_t>(name.size()));
    directory +=
        "PK\1\2" + zeros + zeros.substr(0, 4) + size + size + name_size + zeros + offset + name;
    archive += "PK\3\4" + zeros + zeros.substr(0, 2) + size + size + name_size +
               zeros.substr(0, 2) + name + data;
  }
  const auto count = bytes_of_number(static_cast<std::uint16_t>(files.size()));
  return archive + directory + "PK\5\6" + zeros.substr(0, 4) + count + count +
         bytes_of_number(static_cast<std::uint32_t>(directory.size())) +
         bytes_of_number(static_cast<std::uint32_t>(archive.size())) + zeros.substr(0, 2);
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
  write_file(folder_ / "in.npz", good, true);
  expect_samples(import("in.npz"), 1000);
  RandomStream random(1, "damaged archives");
  for (int i = 0; i < 200; ++i) {
    std::string damaged = good.substr(0, i % 4 == 0 ? random.below(good.size()) : good.size());
    for (int j = 0; j < 3 && !damaged.empty(); ++j)
      damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    testing::put(folder_ / "in.npz", damaged);
    try {
      import("in.npz");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data) << error.what();
    }
  }
}

TEST_F(Import, RejectsWhatIsNotASource) {
  expect_rejected("missing", "does not exist");
  write_file(folder_ / "empty" / "readme.txt", "nothing", true);
  expect_rejected("empty", "give one of: TUM RGB-D folder");
  write_file(folder_ / "bad.npz", "PK\5\6", true);
  expect_rejected("bad.npz", "cannot read");
  write_import_tum(folder_ / "tum");
  write_file(folder_ / "tum" / "camera_info.yaml",
             "height: 480\nwidth: 640\nK: [7.0, 0.0, 4.0, 0.0, 7.0, 3.0, 0.0, 0.0, 1.0]\n", true);
  expect_rejected("tum", "640x480");
}

}  // namespace
}  // namespace touchtrace
