#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

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

TEST(RecordingH5py, SoHaveLabels) {
  const TemporaryFolder folder;
  write_labels(folder / "l.h5", sample_labels(sample_recording().recording), false);
  const Outcome opened = open_in_h5py(folder / "l.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
}

}  // namespace
}  // namespace touchtrace
