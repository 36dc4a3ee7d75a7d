#include <gtest/gtest.h>

#include "tests/pipeline/import_samples.h"
#include "tests/support/bag_writer.h"
#include "tests/support/compress.h"

namespace touchtrace {
namespace {

using testing::BagWriter;
using testing::bz2;
using testing::lz4;
using ImportBag = Import;

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

TEST_F(ImportBag, ReadsBags) {
  for (const bool is_compressed : {false, true}) {
    add_file("my.bag", import_bag(is_compressed).bag());
    expect_bag_samples(import("my.bag"));
  }
}

TEST_F(ImportBag, ChoosesTopicsOfBags) {
  add_file("my.bag", import_bag(false).bag());
  ImportOptions options;
  options.source.depth_topic = "/camera/depth/image_rect_raw";
  const RecordingReader reader = import("my.bag", options);
  EXPECT_FALSE(reader.recording().camera.is_registered);
  EXPECT_EQ(reader.read_camera_frame(0).depth[0], 500);
  options.source.depth_topic = "/depth";
  expect_rejected("my.bag", "/camera/aligned_depth_to_color/image_raw (16UC1)", options);
}

TEST_F(ImportBag, ReadsCompressedBagsAndNamesOtherCompression) {
  const BagWriter bag = import_bag(false);
  for (const auto& [name, chunk] :
       {std::pair{"lz4", lz4(bag.chunk())}, {"bz2", bz2(bag.chunk())}}) {
    SCOPED_TRACE(name);
    write_file(folder_ / "my.bag", bag.bag(name, chunk), true);
    expect_samples(import("my.bag"), 1000);
    write_file(folder_ / "my.bag", bag.bag(name, chunk.substr(0, chunk.size() / 2)), true);
    expect_rejected("my.bag", "cannot read");
  }
  write_file(folder_ / "my.bag", bag.bag("zstd", bag.chunk()), true);
  expect_rejected("my.bag", "rosbag decompress");
}

TEST_F(ImportBag, SurvivesDamagedBags) {
  const BagWriter writer = import_bag(true);
  expect_damage_survived("my.bag", writer.bag("lz4", lz4(writer.chunk())), 75);
  expect_damage_survived("my.bag", writer.bag("bz2", bz2(writer.chunk())), 75);
}

}  // namespace
}  // namespace touchtrace
