#include "pipeline/acquire/import/import.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "pipeline/recording/recording_file.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/bag_writer.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using testing::BagWriter;
using testing::TemporaryFolder;

constexpr int import_width = 8, import_height = 6, import_frames = 4;
constexpr double import_start_s = 1700000000.25;

/// Colour image whose pixel (1, 0) tells its number.
cv::Mat import_color(int i) {
  cv::Mat image(import_height, import_width, CV_8UC3, cv::Scalar(10, 20, 30));
  image.at<cv::Vec3b>(0, 1) = {1, 2, static_cast<std::uint8_t>(100 + i)};  // blue, green, red
  return image;
}

cv::Mat import_depth(int i, int per_m) {
  cv::Mat image(import_height, import_width, CV_16UC1, cv::Scalar(per_m));
  image.at<std::uint16_t>(2, 3) = static_cast<std::uint16_t>(per_m + 5 * i);
  return image;
}

std::string encoded(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

std::string pixels(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

const char* const import_info =
    "height: 6\nwidth: 8\ndistortion_model: plumb_bob\nD: []\n"
    "K: [7.0, 0.0, 4.0, 0.0, 7.0, 3.0, 0.0, 0.0, 1.0]\n---\n";

/// TUM folder: 30 Hz, depth 4 ms after colour.
void write_import_tum(const fs::path& folder, int per_m = 5000) {
  std::string rgb = "# timestamp filename\n", depth = rgb;
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = std::to_string(i) + ".png";
    write_file(folder / "rgb" / name, encoded(import_color(i)), true);
    write_file(folder / "depth" / name, encoded(import_depth(i, per_m)), true);
    rgb += fmt::format("{:.6f} rgb/{}\n", import_start_s + i / 30.0, name);
    depth += fmt::format("{:.6f} depth/{}\n", import_start_s + i / 30.0 + 0.004, name);
  }
  write_file(folder / "rgb.txt", rgb, true), write_file(folder / "depth.txt", depth, true);
  write_file(folder / "camera_info.yaml", import_info, true);
}

class Import : public ::testing::Test {
 protected:
  void SetUp() override { Progress::silence(); }
  RecordingReader import(const std::string& source, const ImportOptions& options = {}) {
    summary_ = import_recording(folder_ / source, folder_ / "out.h5", options,
                                start_provenance("touchtrace/recording/2", "import"), true);
    return RecordingReader(folder_ / "out.h5");
  }
  void expect_rejected(const std::string& source, const std::string& text,
                       const ImportOptions& options = {}) {
    try {
      import(source, options);
      ADD_FAILURE() << "accepted, instead of " << text;
    } catch (const Error& error) {
      EXPECT_NE((std::string(error.what()) + error.hint()).find(text), std::string::npos)
          << error.what() << "; " << error.hint();
    }
    EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
  }
  /// Expects all frames of the samples above, at 30 Hz.
  void expect_samples(const RecordingReader& reader, int counts_at_1m) {
    const Recording& r = reader.recording();
    ASSERT_EQ(r.camera_times.frames(), std::size_t(import_frames));
    EXPECT_NEAR(r.camera_times.host_time_s[3] - r.camera_times.host_time_s[0], 0.1, 1e-5);
    EXPECT_NEAR(r.camera.depth_unit_m * counts_at_1m, 1.0, 1e-9);
    for (int i = 0; i < import_frames; ++i) {
      const RgbdFrame frame = reader.read_camera_frame(i);
      EXPECT_EQ(frame.color[3], 100 + i) << "red comes first";
      EXPECT_EQ(frame.color[5], 1);
      EXPECT_EQ(frame.depth[0], counts_at_1m);
      EXPECT_EQ(frame.depth[2 * import_width + 3], counts_at_1m + 5 * i);
    }
    ASSERT_EQ(r.clips.size(), 1u);
    EXPECT_LE(r.clips[0].start_s, r.camera_times.host_time_s[0]);
    EXPECT_GT(r.clips[0].end_s, r.camera_times.host_time_s[3]);
  }

  TemporaryFolder folder_;
  nlohmann::json summary_;
};

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
  EXPECT_EQ(summary_["left_out"], 2);
  EXPECT_EQ(reader.color_images(), 3u);
  EXPECT_EQ(reader.depth_images(), 3u);
  EXPECT_EQ(reader.read_camera_frame(0).color[3], 100);
  for (const char* name : {"0.png", "2.png"}) write_file(folder_ / "tum" / "rgb" / name, "", true);
  fs::remove(folder_ / "out.h5");
  expect_rejected("tum", "3 of 4 colour images");
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
}

/// .npy file of version 1.
std::string npy(const std::string& type, const std::string& shape, const std::string& data) {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize(118, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + data;
}

TEST_F(Import, ReadsDepthArrays) {
  for (int i = 0; i < import_frames; ++i) {
    cv::Mat metres;
    import_depth(i, 4000).convertTo(metres, CV_32F, 1.0 / 4000.0);
    const std::string name = fmt::format("{:.6f}", import_start_s + i / 30.0);
    write_file(folder_ / "in" / "rgb" / (name + ".png"), encoded(import_color(i)), true);
    write_file(folder_ / "in" / "depth" / (name + ".npy"), npy("<f4", "(6, 8)", pixels(metres)),
               true);
  }
  expect_samples(import("in"), 4000);
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

/// Bag with an unregistered and a registered depth topic.
BagWriter import_bag(bool is_compressed) {
  BagWriter bag;
  const std::string type = is_compressed ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image";
  const auto suffix = [&](const char* name) { return std::string(is_compressed ? name : ""); };
  const auto color = bag.connect("/camera/color/image_raw" + suffix("/compressed"), type);
  const auto own = bag.connect("/camera/depth/image_rect_raw" + suffix("/compressedDepth"), type);
  const auto aligned =
      bag.connect("/camera/aligned_depth_to_color/image_raw" + suffix("/compressedDepth"), type);
  const auto info = bag.connect("/camera/color/camera_info", "sensor_msgs/CameraInfo");
  bag.add(info, 1700000000, 0, testing::ros_camera_info(import_width, import_height, 7.0));
  for (int i = 0; i < import_frames; ++i) {
    const double stamp_s = 1700000000.0 + i / 30.0;
    const auto host_ns = static_cast<std::uint32_t>(250'000'000 + i * 33'333'333);
    const auto add = [&](std::uint32_t topic, const char* frame, const char* encoding,
                         const cv::Mat& image, const std::string& prefix) {
      bag.add(topic, 1700000000, host_ns,
              is_compressed
                  ? testing::ros_compressed(stamp_s, frame, encoding, prefix + encoded(image))
                  : testing::ros_image(stamp_s, frame, encoding, import_width, import_height,
                                       pixels(image)));
    };
    add(color, "color", is_compressed ? "bgr8; png compressed bgr8" : "bgr8", import_color(i), "");
    const char* encoding = is_compressed ? "16UC1; compressedDepth" : "16UC1";
    const std::string prefix(12, '\0');
    add(own, "depth", encoding, cv::Mat(import_height, import_width, CV_16UC1, 500), prefix);
    add(aligned, "color", encoding, import_depth(i, 1000), prefix);
  }
  return bag;
}

TEST_F(Import, ReadsBags) {
  for (const bool is_compressed : {false, true}) {
    write_file(folder_ / "my.bag", import_bag(is_compressed).bag(), true);
    const RecordingReader reader = import("my.bag");
    expect_samples(reader, 1000);
    const Recording& r = reader.recording();
    EXPECT_TRUE(r.camera.is_registered);
    EXPECT_EQ(r.camera.color_camera->fx, 7.0);
    EXPECT_NEAR(r.epoch_unix_s, import_start_s, 1e-6);
    EXPECT_NEAR(r.camera_times.device_time_s[1] - r.camera_times.host_time_s[1], -0.25, 1e-6);
  }
}

TEST_F(Import, ChoosesTopicsOfBags) {
  write_file(folder_ / "my.bag", import_bag(false).bag(), true);
  ImportOptions options;
  options.source.depth_topic = "/camera/depth/image_rect_raw";
  const RecordingReader reader = import("my.bag", options);
  EXPECT_FALSE(reader.recording().camera.is_registered);
  EXPECT_EQ(reader.read_camera_frame(0).depth[0], 500);
  fs::remove(folder_ / "out.h5");
  options.source.depth_topic = "/depth";
  expect_rejected("my.bag", "/camera/aligned_depth_to_color/image_raw (16UC1)", options);
}

/// LZ4 frame with literals only.
std::string lz4_literals(const std::string& bytes) {
  std::string block = "\xf0";
  for (std::size_t rest = bytes.size() - 15; true; rest -= 255) {
    block += static_cast<char>(std::min<std::size_t>(rest, 255));
    if (rest < 255) break;
  }
  block += bytes;
  return std::string("\x04\x22\x4d\x18\x60\x70\x73", 7) + testing::sized(block) +
         std::string(4, '\0');
}

TEST_F(Import, ReadsLz4AndNamesOtherCompression) {
  const BagWriter bag = import_bag(false);
  write_file(folder_ / "my.bag", bag.bag("lz4", lz4_literals(bag.chunk())), true);
  expect_samples(import("my.bag"), 1000);
  fs::remove(folder_ / "out.h5");
  write_file(folder_ / "my.bag", bag.bag("bz2", bag.chunk()), true);
  expect_rejected("my.bag", "rosbag decompress");
}

TEST_F(Import, SurvivesDamagedBags) {
  const BagWriter writer = import_bag(true);
  const std::string good = writer.bag("lz4", lz4_literals(writer.chunk()));
  RandomStream random(1, "damaged bags");
  for (int i = 0; i < 150; ++i) {
    std::string bag = good.substr(0, i % 3 == 0 ? random.below(good.size()) : good.size());
    for (int j = 0; j < i % 5 && !bag.empty(); ++j)
      bag[random.below(bag.size())] = static_cast<char>(random.below(256));
    testing::put(folder_ / "my.bag", bag);
    try {
      import("my.bag");
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
