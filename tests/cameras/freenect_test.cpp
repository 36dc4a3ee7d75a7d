// Kinect (v1) with Debian's fakenect in place of libfreenect: it plays a folder of images.
#include <gtest/gtest.h>

#include <fstream>

#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/recording/recording_file.h"
#include "tests/cameras/recorded_images.h"
#include "tests/support/program.h"

namespace touchtrace {
namespace {

using testing::RecordedImages;
using testing::run_program;

constexpr int width = 640, height = 480;
constexpr std::size_t pixels = width * height;
constexpr double ticks_per_s = 60e6;
constexpr std::uint64_t first_ticks = 0xffff'ffff - 5'000'000;  // wraps in the third period
constexpr std::uint64_t period_ticks = 2'000'000, color_delay_ticks = 300'000;

/// Images of one stream and their numbers.
template <class Value>
struct Images {
  std::vector<std::uint64_t> numbers;
  std::vector<std::vector<Value>> values;
};

struct Dump {
  Images<std::uint16_t> depth;
  Images<std::uint8_t> color;
};

std::uint64_t depth_ticks(std::uint64_t number) { return first_ticks + number * period_ticks; }
std::uint64_t color_ticks(std::uint64_t number) { return depth_ticks(number) + color_delay_ticks; }

/// Adds a random image to the dump, 1 ms after the one before. Its stamp is cut to 32 bits.
template <class Value>
void add_image(const std::filesystem::path& folder, RandomStream& random, std::uint64_t number,
               char kind, std::uint64_t ticks, const std::string& header, Images<Value>& images) {
  std::vector<Value> values(sizeof(Value) == 1 ? 3 * pixels : pixels);
  for (Value& value : values) value = static_cast<Value>(random.below(10'000));
  static int index = 0;
  const std::string name =
      fmt::format("{}-{:.3f}-{}-0", kind, 1.0 + 1e-3 * ++index, static_cast<std::uint32_t>(ticks));
  std::ofstream file(folder / name, std::ios::binary);
  file << header;
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(Value)));
  std::ofstream(folder / "INDEX.txt", std::ios::app) << name << "\n";
  images.numbers.push_back(number);
  images.values.push_back(std::move(values));
}

/// Eight images of each kind; of depth, number 4 was lost.
Dump write_dump(const std::filesystem::path& folder) {
  RandomStream random(1, "kinect");
  Dump dump;
  for (std::uint64_t i = 0; i < 8; ++i) {
    if (i != 4) add_image(folder, random, i, 'd', depth_ticks(i), "P5 640 480 65535\n", dump.depth);
    add_image(folder, random, i, 'r', color_ticks(i), "P6 640 480 255\n", dump.color);
  }
  return dump;
}

/// Records a dump until its end.
testing::ProgramResult record(const std::filesystem::path& dump,
                              const std::filesystem::path& output) {
  return run_program(fmt::format("record --camera freenect --output {}", output.string()),
                     fmt::format("LD_LIBRARY_PATH={} LD_PRELOAD={} FAKENECT_PATH={} ",
                                 FAKENECT_FOLDER, FREENECT_MODES, dump.string()));
}

/// Images are those of the dump, and their stamps those of the device without the wrap.
template <class Value>
void expect_images(const RecordedImages<Value>& recorded, const Images<Value>& sent,
                   std::uint64_t (*ticks)(std::uint64_t)) {
  ASSERT_EQ(recorded.sequence, sent.numbers);
  EXPECT_TRUE(std::ranges::is_sorted(recorded.host_time_s));
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    EXPECT_TRUE(recorded.image(i) == sent.values[i]) << i;
    EXPECT_DOUBLE_EQ(recorded.device_time_s[i],
                     static_cast<double>(ticks(sent.numbers[i])) / ticks_per_s);
  }
}

TEST(Freenect, RecordsWhatTheLibraryDelivers) {
  const ScratchFolder folder;
  const Dump dump = write_dump(folder.path());
  const auto result = record(folder.path(), folder.path() / "a.h5");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("freenect:0: no longer connected"), std::string::npos)
      << result.output;

  const RecordingReader reader(folder.path() / "a.h5");
  const CameraInfo& camera = reader.recording().camera;
  EXPECT_EQ(camera.width, width);
  EXPECT_EQ(camera.height, height);
  EXPECT_TRUE(camera.is_registered);
  EXPECT_EQ(camera.depth_unit_m, 0.001);
  EXPECT_FALSE(camera.color_camera);
  expect_images({reader.path(), "depth"}, dump.depth, depth_ticks);
  expect_images({reader.path(), "color"}, dump.color, color_ticks);
}

TEST(Freenect, ADeviceThatIsMissingIsAnError) {
  const ScratchFolder folder;
  const std::string output = folder.path() / "a.h5";
  const auto missing = run_program("record --camera freenect:99 --output " + output);
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.output.find("the camera freenect:99"), std::string::npos) << missing.output;
  EXPECT_NE(missing.output.find("hint: check with `lsusb`"), std::string::npos);
  EXPECT_EQ(run_program("record --camera freenect:one --output " + output).exit_code, 2);
  EXPECT_EQ(
      run_program("record --camera freenect --depth-camera /dev/null --output " + output).exit_code,
      2);
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace touchtrace
