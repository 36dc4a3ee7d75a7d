// OpenNI2 with a driver of a simulated camera, and with a file that OpenNI2 recorded of it.
#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/base/scratch_folder.h"
#include "pipeline/recording/recording_file.h"
#include "tests/cameras/recorded_images.h"
#include "tests/cameras/simulated_camera.h"
#include "tests/support/program.h"

namespace touchtrace {
namespace {

using testing::RecordedImages;
using testing::run_program;
using testing::simulated_height;
using testing::simulated_width;
namespace fs = std::filesystem;

const std::string with_driver = "LD_LIBRARY_PATH=" OPENNI2_FOLDER " ";

void fill(int number, bool, std::vector<std::uint8_t>& values) {
  for (int y = 0; y < simulated_height; ++y)
    for (int x = 0; x < simulated_width; ++x)
      for (int c = 0; c < 3; ++c) values.push_back(testing::simulated_color(x, y, c, number));
}

void fill(int number, bool is_registered, std::vector<std::uint16_t>& values) {
  for (int y = 0; y < simulated_height; ++y)
    for (int x = 0; x < simulated_width; ++x)
      values.push_back(testing::simulated_depth(x, y, number, is_registered));
}

/// Images have the pixels and stamps that their numbers say. `earlier`: images before number 1.
/// `first_us`: stamp that is 0.
template <class Value>
void expect_images(const RecordedImages<Value>& images, bool is_registered, int earlier,
                   std::uint64_t first_us) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int number = static_cast<int>(images.sequence[i]) + earlier;
    std::vector<Value> expected;
    fill(number, is_registered, expected);
    EXPECT_TRUE(images.image(i) == expected) << number;
    const auto stamp_us = testing::simulated_stamp_us(number, sizeof(Value) == 1) - first_us;
    EXPECT_DOUBLE_EQ(images.device_time_s[i], 1e-6 * static_cast<double>(stamp_us)) << number;
  }
}

/// Expects all images of a file, in which numbers and stamps start again. OpenNI2's recorder may
/// miss the first images of the camera: the first pixel, `start` + `step` * number, shows how many.
template <class Value>
void expect_all_images(const RecordedImages<Value>& images, int start, int step) {
  ASSERT_GT(images.size(), 0u);
  const int first = (images.values[0] - start) / step;
  EXPECT_EQ(images.size(), static_cast<std::size_t>(testing::simulated_frames - first + 1));
  expect_images(images, false, first - 1, testing::simulated_stamp_us(first, sizeof(Value) == 1));
}

void expect_camera(const std::string& path, bool is_registered) {
  const RecordingReader reader(path);
  const CameraInfo& camera = reader.recording().camera;
  EXPECT_EQ(camera.width, simulated_width);
  EXPECT_EQ(camera.height, simulated_height);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
  EXPECT_EQ(camera.is_registered, is_registered);
}

/// A busy machine may lose some images of a device.
TEST(Openni2, RecordsADeviceUntilItIsUnplugged) {
  const ScratchFolder folder;
  const std::string output = folder.path() / "a.h5";
  const auto result = run_program(
      "record --camera openni2 --width 320 --height 240 --output " + output, with_driver);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("openni2: no longer connected"), std::string::npos) << result.output;
  expect_camera(output, true);
  const RecordedImages<std::uint16_t> depth(output, "depth");
  const RecordedImages<std::uint8_t> color(output, "color");
  EXPECT_GT(depth.size(), 5u);
  EXPECT_GT(color.size(), 5u);
  expect_images(depth, true, 0, 0);
  expect_images(color, true, 0, 0);
}

/// The file's images are mirrored.
TEST(Openni2, RecordsAllImagesOfAFile) {
  const ScratchFolder folder;
  const std::string file = folder.path() / "a.oni", output = folder.path() / "a.h5";
  ASSERT_EQ(std::system((with_driver + RECORD_ONI + " " + file).c_str()), 0);
  const auto result = run_program(
      fmt::format("record --camera {} --speed 0 --output {}", file, output), with_driver);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  expect_camera(output, false);
  expect_all_images(RecordedImages<std::uint16_t>(output, "depth"), 500, 5);
  expect_all_images(RecordedImages<std::uint8_t>(output, "color"), 0, 7);
}

TEST(Openni2, AFileThatIsMissingOrDamagedIsAnError) {
  const ScratchFolder folder;
  const std::string file = folder.path() / "a.oni", output = folder.path() / "a.h5";
  const std::string arguments = fmt::format("record --camera {} --output {}", file, output);
  const auto missing = run_program(arguments);
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.output.find("cannot open the camera " + file), std::string::npos)
      << missing.output;
  ASSERT_EQ(std::system((with_driver + RECORD_ONI + " " + file).c_str()), 0);
  fs::resize_file(file, fs::file_size(file) / 2);
  const auto damaged = run_program(arguments + " --speed 0");
  EXPECT_NE(damaged.output.find(file + ": the file is damaged"), std::string::npos)
      << damaged.output;
}

}  // namespace
}  // namespace touchtrace
