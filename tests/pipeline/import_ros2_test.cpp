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
    fs::remove_all(folder_ / "in");
    fs::copy(bags / name, folder_ / "in");
    expect_bag_samples(import("in"));
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
  for (const char* name :
       {"sqlite3/sqlite3.db3", "chunks_zstd.mcap", "chunks_lz4.mcap", "mcap/mcap.mcap"})
    expect_damage_survived("bag", read_file(bags / name, 1u << 20), 50);
}

}  // namespace
}  // namespace touchtrace
