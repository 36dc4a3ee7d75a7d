#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

#include "engine/base/error.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

struct Outcome {
  int status;
  std::string output;
};

Outcome open_in_h5py(const std::filesystem::path& file) {
  const std::string command =
      fmt::format("/usr/bin/python3 {}/tests/pipeline/recording_h5py.py {} 2>&1",
                  TOUCHTRACE_SOURCE_DIR, file.string());
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c; (c = std::fgetc(pipe)) != EOF;) output += static_cast<char>(c);
  return {pclose(pipe), output};
}

template <class T>
std::uint64_t sum_of(const std::vector<T>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

TEST(RecordingH5py, EveryDatasetHasUnitsScalesAndChecksums) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  const Outcome opened = open_in_h5py(folder / "a.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
  EXPECT_EQ(opened.output, fmt::format("{} {}\n", sum_of(sample.recording.gloves[0].counts),
                                       sum_of(sample.frames[3].depth)));
}

TEST(RecordingH5py, SoHasTheInertialUnit) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  InertialStream& unit = sample.recording.gloves[0].inertial.emplace();
  unit.place_m = {-0.02, 0.0, -0.03};
  for (unsigned i = 0; i < 5; ++i) {
    unit.sequence.push_back(100 + i);
    unit.host_time_s.push_back(10.0 + 0.01 * i);
    unit.specific_force_m_per_s2.insert(unit.specific_force_m_per_s2.end(), {0.25f, -0.5f, 9.75f});
    unit.angular_velocity_rad_per_s.insert(unit.angular_velocity_rad_per_s.end(), {1, 2, 3});
    unit.orientation_wxyz.insert(unit.orientation_wxyz.end(), {1, 0, 0, 0});
  }
  write(sample, folder / "a.h5");
  const Outcome opened = open_in_h5py(folder / "a.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
  EXPECT_TRUE(opened.output.starts_with("47.5\n")) << opened.output;
  const RecordingReader reader(folder / "a.h5");
  const auto& read = reader.recording().gloves[0].inertial;
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->place_m, unit.place_m);
  EXPECT_EQ(read->host_time_s, unit.host_time_s);
  EXPECT_EQ(read->angular_velocity_rad_per_s, unit.angular_velocity_rad_per_s);
  unit.orientation_wxyz[3] = std::nanf("");
  write(sample, folder / "b.h5");
  EXPECT_THROW(RecordingReader(folder / "b.h5"), Error);
}

TEST(RecordingH5py, SoHaveLabels) {
  const TemporaryFolder folder;
  write_labels(folder / "l.h5", sample_labels(sample_recording().recording), false);
  const Outcome opened = open_in_h5py(folder / "l.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
}

}  // namespace
}  // namespace touchtrace
