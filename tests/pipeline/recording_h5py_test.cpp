#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::PythonResult;
using testing::run_python;
using testing::sample_labels;
using testing::sample_recording;
using testing::TemporaryFolder;

PythonResult open_in_h5py(const std::filesystem::path& file) {
  return run_python(TOUCHTRACE_SOURCE_DIR "/tests/pipeline/recording_h5py.py " + file.string());
}

template <class T>
std::uint64_t sum_of(const std::vector<T>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

TEST(RecordingH5py, EveryDatasetHasUnitsScalesAndChecksums) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "a.h5");
  const PythonResult opened = open_in_h5py(folder / "a.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
  EXPECT_EQ(opened.output, fmt::format("{} {}\n", sum_of(sample.recording.gloves[0].counts),
                                       sum_of(sample.frames[3].depth)));
}

TEST(RecordingH5py, InertialUnitIsReadable) {
  const TemporaryFolder folder;
  auto sample = sample_recording();
  InertialStream& unit = sample.recording.gloves[0].inertial.emplace();
  unit.position_m = {-0.02, 0.0, -0.03};
  for (unsigned i = 0; i < 5; ++i) {
    unit.sequence.push_back(100 + i);
    unit.host_time_s.push_back(10.0 + 0.01 * i);
    unit.specific_force_m_per_s2.insert(unit.specific_force_m_per_s2.end(), {0.25f, -0.5f, 9.75f});
    unit.angular_velocity_rad_per_s.insert(unit.angular_velocity_rad_per_s.end(), {1, 2, 3});
    unit.orientation_wxyz.insert(unit.orientation_wxyz.end(), {1, 0, 0, 0});
  }
  write(sample, folder / "a.h5");
  const PythonResult opened = open_in_h5py(folder / "a.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
  EXPECT_TRUE(opened.output.starts_with("47.5\n")) << opened.output;
  const RecordingReader reader(folder / "a.h5");
  const auto& read = reader.recording().gloves[0].inertial;
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->position_m, unit.position_m);
  EXPECT_EQ(read->host_time_s, unit.host_time_s);
  EXPECT_EQ(read->angular_velocity_rad_per_s, unit.angular_velocity_rad_per_s);
  unit.orientation_wxyz[3] = std::nanf("");
  write(sample, folder / "b.h5");
  EXPECT_THROW(RecordingReader(folder / "b.h5"), Error);
}

TEST(RecordingH5py, LabelsHaveUnitsScalesAndChecksums) {
  const TemporaryFolder folder;
  write_labels(folder / "l.h5", sample_labels(sample_recording().recording), false);
  const PythonResult opened = open_in_h5py(folder / "l.h5");
  EXPECT_EQ(opened.status, 0) << opened.output;
}

/// Python code blocks of pipeline/recording/README.md.
std::vector<std::string> readme_examples() {
  const std::string text =
      read_file(std::filesystem::path(TOUCHTRACE_SOURCE_DIR) / "pipeline/recording/README.md");
  std::vector<std::string> examples;
  const std::string begin = "```python\n", end = "```";
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    examples.push_back(text.substr(at, text.find(end, at) - at));
  }
  return examples;
}

PythonResult run_example(const TemporaryFolder& folder, const std::string& example) {
  testing::put(folder / "example.py",
               "import os\nos.chdir('" + folder.path().string() + "')\n" + example);
  return run_python(folder / "example.py");
}

TEST(RecordingReadme, ExampleReadsLabels) {
  const TemporaryFolder folder;
  Labels labels = sample_labels(sample_recording().recording);
  labels.object.quality[2] = quality_lost;
  labels.object.covariance.assign(labels.object.covariance.size(), 0.0);
  for (std::size_t i = 0; i < labels.time_s.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d) labels.object.covariance[36 * i + 7 * d] = 4e-6;
  write_labels(folder / "wave.labels.h5", labels, false);
  std::string expected;
  for (int clip = 0; clip < 2; ++clip) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (std::size_t i = 0; i < labels.time_s.size(); ++i)
      if (labels.clip[i] == clip && i != 2)
        sum += Eigen::Map<const Eigen::Vector3d>(&labels.object.position_m[3 * i]), ++count;
    sum /= count;
    expected += fmt::format(
        "clip {}, {}: {} labels, mean position {:.4f} {:.4f} {:.4f} m, mean sigma 2.00 mm\n", clip,
        labels.clips[static_cast<std::size_t>(clip)].object, count, sum.x(), sum.y(), sum.z());
  }
  const auto examples = readme_examples();
  ASSERT_EQ(examples.size(), 2u);
  const PythonResult outcome = run_example(folder, examples[0]);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output, expected);
}

TEST(RecordingReadme, ExampleReadsGloveFrames) {
  const TemporaryFolder folder;
  const auto sample = sample_recording();
  write(sample, folder / "wave.h5");
  const GloveStream& glove = sample.recording.gloves[0];
  std::string expected;
  for (std::size_t clip = 0; clip < 2; ++clip) {
    double sum = 0.0;
    for (std::size_t i = clip * 19 * 30; i < (clip + 1) * 19 * 30; ++i)
      if (glove.info.mask[i % 30])
        sum +=
            std::clamp((glove.counts[i] - glove.info.baseline_counts[i % 30]) / 1023.0, 0.0, 1.0);
    expected +=
        fmt::format("clip {}: 19 frames, 1 lost, mean pressure {:.5f}\n", clip, sum / (19 * 30));
  }
  const auto examples = readme_examples();
  ASSERT_EQ(examples.size(), 2u);
  const PythonResult outcome = run_example(folder, examples[1]);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output, expected);
}

}  // namespace
}  // namespace touchtrace
