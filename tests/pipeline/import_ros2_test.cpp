#include "engine/base/random.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

using ImportRos2 = Import;

const fs::path bags = fs::path(TOUCHTRACE_SOURCE_DIR) / "tests" / "data" / "ros2_bags";

constexpr const char* bag_names[] = {"sqlite3", "mcap", "sqlite3_zstd_messages", "chunks_zstd.mcap",
                                     "chunks_lz4.mcap"};

/// Files of the packages rosbags and mcap.
TEST_F(ImportRos2, ReadsBags) {
  for (const char* name : bag_names) {
    SCOPED_TRACE(name);
    fs::remove_all(folder_ / "in"), fs::remove(folder_ / "out.h5");
    fs::copy(bags / name, folder_ / "in");
    const RecordingReader reader = import("in");
    expect_samples(reader, 1000);
    const Recording& r = reader.recording();
    EXPECT_TRUE(r.camera.is_registered);
    ASSERT_TRUE(r.camera.color_camera);
    EXPECT_EQ(r.camera.color_camera->fx, 7.0);
    EXPECT_EQ(r.camera.color_camera->cy, 3.0);
    EXPECT_NEAR(r.epoch_unix_s, import_start_s, 1e-6);
    EXPECT_NEAR(r.camera_times.device_time_s[1] - r.camera_times.host_time_s[1], -0.25, 1e-6);
  }
}

TEST_F(ImportRos2, ReadsSplitBagsAndSingleFiles) {
  fs::create_directory(folder_ / "in");
  fs::copy_file(bags / "sqlite3" / "sqlite3.db3", folder_ / "in" / "a_0.db3");
  expect_samples(import("in/a_0.db3"), 1000);
  fs::copy_file(bags / "mcap" / "mcap.mcap", folder_ / "in" / "a_1.mcap");
  const RecordingReader both = import("in");
  EXPECT_EQ(both.recording().camera_times.frames(), std::size_t(2 * import_frames));
}

TEST_F(ImportRos2, NamesBagsThatAreCompressedAsFiles) {
  fs::copy(bags / "sqlite3", folder_ / "in");
  fs::rename(folder_ / "in" / "sqlite3.db3", folder_ / "in" / "sqlite3.db3.zstd");
  write_file(folder_ / "in" / "sqlite3.db3.zstd", "zstd", true);
  expect_rejected("in", "zstd -d");
}

TEST_F(ImportRos2, SurvivesDamagedBags) {
  RandomStream random(1, "damaged bags of ROS 2");
  const std::vector files{bags / "sqlite3" / "sqlite3.db3", bags / "chunks_zstd.mcap",
                          bags / "chunks_lz4.mcap", bags / "mcap" / "mcap.mcap"};
  for (std::size_t i = 0; i < 200; ++i) {
    std::string bytes = read_file(files[i % 4], 1u << 20);
    if (i % 3 == 0) bytes.resize(random.below(bytes.size()));
    for (std::size_t j = 0; j < 1 + i % 6 && !bytes.empty(); ++j)
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    write_file(folder_ / "bag", bytes, true);
    try {
      import("bag");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::data) << error.what();
    }
  }
}

}  // namespace
}  // namespace touchtrace
