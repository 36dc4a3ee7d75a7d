#include <gtest/gtest.h>

#include "engine/base/files.h"
#include "tests/export/python.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::TemporaryFolder;

/// Exports a recording whose glove has this rate.
testing::PythonResult export_at(double rate_hz, const TemporaryFolder& folder,
                                const std::string& options) {
  auto sample = testing::sample_recording();
  sample.recording.gloves[0].info.rate_hz = rate_hz;
  testing::write(sample, folder / "a.h5");
  return testing::run_python(fmt::format("{}/scripts/export_lerobot.py {} {} {}",
                                         TOUCHTRACE_SOURCE_DIR, (folder / "a.h5").string(),
                                         (folder / "set").string(), options));
}

TEST(ExportLerobot, RateIsAWholeNumber) {
  SKIP_WITHOUT_MODULES("h5py, pandas, pyarrow");
  const TemporaryFolder measured, far, chosen;
  auto result = export_at(15.0021, measured, "");
  EXPECT_EQ(result.status, 0) << result.output;
  const auto info = nlohmann::json::parse(read_file(measured / "set/meta/info.json"));
  EXPECT_EQ(info["fps"], 15);
  EXPECT_EQ(info["features"]["observation.tactile"]["info"]["rate_hz"], 15.0021);
  result = export_at(7.5, far, "");
  EXPECT_NE(result.output.find("hint: give --fps 8"), std::string::npos) << result.output;
  EXPECT_EQ(export_at(7.5, chosen, "--fps 8").status, 0);
}

TEST(ExportLerobot, ARecordingWithoutClipsIsOneEpisode) {
  SKIP_WITHOUT_MODULES("h5py, pandas, pyarrow");
  const TemporaryFolder folder;
  const std::string path = (folder / "a.h5").string();
  const std::string write =
      "-c \"import h5py, numpy as np; f = h5py.File('" + path +
      "', 'w'); g = f.create_group('glove0'); g['host_time_s'] = np.arange(60) / 20; "
      "g['counts'] = np.zeros((60, 2, 3), np.uint16); f.attrs['schema'] = "
      "'touchtrace/recording/2'\"";
  ASSERT_EQ(testing::run_python(write).status, 0);
  const auto result =
      testing::run_python(fmt::format("{}/scripts/export_lerobot.py {} {}", TOUCHTRACE_SOURCE_DIR,
                                      path, (folder / "set").string()));
  EXPECT_EQ(result.status, 0) << result.output;
  const auto info = nlohmann::json::parse(read_file(folder / "set/meta/info.json"));
  EXPECT_EQ(info["total_episodes"], 1);
  EXPECT_EQ(info["total_frames"], 60);
}

TEST(ExportLerobot, ARecordingNeedsNoImages) {
  SKIP_WITHOUT_MODULES("h5py, pandas, pyarrow");
  const TemporaryFolder folder;
  auto sample = testing::sample_recording();
  sample.frames.clear(), sample.recording.camera_times = {}, sample.recording.color_times = {};
  testing::write(sample, folder / "a.h5");
  const auto result =
      testing::run_python(fmt::format("{}/scripts/export_lerobot.py {} {}", TOUCHTRACE_SOURCE_DIR,
                                      (folder / "a.h5").string(), (folder / "set").string()));
  EXPECT_EQ(result.status, 0) << result.output;
  const auto info = nlohmann::json::parse(read_file(folder / "set/meta/info.json"));
  EXPECT_EQ(info["total_frames"], 40);
  EXPECT_FALSE(info["features"].contains("observation.images.color"));
}

}  // namespace
}  // namespace touchtrace
