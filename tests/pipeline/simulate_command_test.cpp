#include <gtest/gtest.h>

#include <array>

#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/recording/labels.h"
#include "pipeline/scene/person/activity.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::TemporaryFolder;

int touchtrace(const std::vector<std::string>& arguments) {
  std::vector<const char*> argv{"touchtrace"};
  for (const auto& argument : arguments) argv.push_back(argument.c_str());
  return cli::run_command_line(cli::touchtrace_program(), static_cast<int>(argv.size()),
                               argv.data());
}

int simulate(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"simulate", "--quiet",  "--no-images", "--minutes",
                                     "0.05",     "--clip-s", "1.5"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return touchtrace(arguments);
}

std::string hash(const std::filesystem::path& path) { return sha256_of(read_file(path)); }

TEST(SimulateCommand, WritesOneRecordingPerObject) {
  const TemporaryFolder folder;
  ASSERT_EQ(simulate({(folder / "two").string(), "--object", "bottle,bottle-empty"}), 0);
  for (const char* name : {"bottle", "bottle-empty"}) {
    const RecordingReader reader(folder / "two" / (std::string(name) + ".h5"));
    EXPECT_EQ(reader.recording().clips.size(), 2u);
    EXPECT_EQ(reader.recording().clips.front().object, name);
    EXPECT_EQ(reader.recording().provenance.options["object"], name);
  }
}

TEST(SimulateCommand, RoleSelectsAllItsObjects) {
  const TemporaryFolder folder;
  ASSERT_EQ(simulate({(folder / "unseen").string(), "--object", "unseen"}), 0);
  for (const scene::ObjectSpec& object : scene::objects())
    EXPECT_EQ(std::filesystem::exists(folder / "unseen" / (object.name + ".h5")),
              object.role == scene::ObjectRole::unseen);
}

TEST(SimulateCommand, CheckReportsNoCameraRateWithoutImages) {
  const TemporaryFolder folder;
  const std::string file = (folder / "touch.h5").string();
  ASSERT_EQ(simulate({file}), 0);
  const std::array argv{"touchtrace", "check", file.c_str()};
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(
      cli::run_command_line(cli::touchtrace_program(), static_cast<int>(argv.size()), argv.data()),
      0);
  const std::string said = ::testing::internal::GetCapturedStdout();
  EXPECT_NE(said.find("camera     0 frames, too few for a rate"), std::string::npos) << said;
  EXPECT_EQ(said.find("nan"), std::string::npos) << said;
}

TEST(SimulateCommand, EveryActivityHasADefaultObject) {
  const TemporaryFolder folder;
  for (const std::string& activity : scene::activity_names()) {
    const auto file = folder / (activity + ".h5");
    ASSERT_EQ(simulate({file.string(), "--activity", activity}), 0) << activity;
    EXPECT_EQ(RecordingReader(file).recording().clips.front().object,
              scene::default_object(activity).name);
  }
}

TEST(SimulateCommand, ResumeSimulatesOnlyMissingRecordings) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const std::vector<std::string> command{out, "--object", "ball,cube", "--resume"};
  ASSERT_EQ(simulate(command), 0);
  const std::string cube = hash(folder / "out/cube.h5");
  const auto written = std::filesystem::last_write_time(folder / "out/cube.h5");
  std::filesystem::remove(folder / "out/ball.h5");
  ASSERT_EQ(simulate(command), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/ball.h5"));
  EXPECT_EQ(hash(folder / "out/cube.h5"), cube);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "out/cube.h5"), written);
  EXPECT_EQ(simulate({out, "--object", "ball,cube", "--resume", "--seed", "2"}), 2);
  EXPECT_EQ(simulate({out, "--object", "ball,cube"}), 2);  // they exist
}

TEST(SimulateCommand, LabelsWithoutStoredImagesEqualThoseOfStoredOnes) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::vector<std::string> scene{"--quiet",  "--activity", "throw",  "--minutes", "0.2",
                                       "--clip-s", "4",          "--seed", "3"};
  const auto with = [&](std::vector<std::string> command) {
    command.insert(command.end(), scene.begin(), scene.end());
    return touchtrace(command);
  };
  ASSERT_EQ(with({"simulate", at("stored.h5")}), 0);
  ASSERT_EQ(touchtrace({"calibrate", "--quiet", at("stored.h5"), "--output", at("camera")}), 0);
  ASSERT_EQ(touchtrace({"label", "--quiet", at("stored.h5"), "--calibration", at("camera"),
                        "--tracker", "component", "--output", at("stored.labels.h5")}),
            0);
  ASSERT_EQ(with({"simulate", at("rendered.h5"), "--label", "--tracker", "component"}), 0);
  EXPECT_EQ(RecordingReader(at("rendered.h5")).color_images(), 0u);
  EXPECT_LT(std::filesystem::file_size(at("rendered.h5")), 1'000'000u);
  const Labels stored = read_labels(at("stored.labels.h5")),
               rendered = read_labels(at("rendered.labels.h5"));
  ASSERT_GT(stored.time_s.size(), 100u);
  EXPECT_EQ(rendered.time_s, stored.time_s);
  EXPECT_EQ(rendered.object.position_m, stored.object.position_m);
  EXPECT_EQ(rendered.hand.position_m, stored.hand.position_m);
  EXPECT_EQ(rendered.object.covariance, stored.object.covariance);
  EXPECT_EQ(rendered.provenance.inputs.front().sha256, hash(at("rendered.h5")));
}

TEST(SimulateCommand, ResumeLabelsARecordingWhoseLabelsAreMissing) {
  const TemporaryFolder folder;
  const std::string file = (folder / "ball.h5").string();
  const std::vector<std::string> command{"simulate",  file,        "--quiet", "--minutes",
                                         "0.1",       "--clip-s",  "3",       "--label",
                                         "--tracker", "component", "--resume"};
  ASSERT_EQ(touchtrace(command), 0);
  const Labels first = read_labels(folder / "ball.labels.h5");
  std::filesystem::remove(folder / "ball.labels.h5");
  ASSERT_EQ(touchtrace(command), 0);
  EXPECT_EQ(read_labels(folder / "ball.labels.h5").object.position_m, first.object.position_m);
}

/// The hand drops a marble in its only clip.
TEST(SimulateCommand, ARecordingThatCannotBeLabelledDoesNotStopTheOthers) {
  const TemporaryFolder folder;
  write_file(folder / "marble.toml",
             "summary = 'a marble'\nrole = 'seen'\nfriction = 0.7\ntoss_apex_m = [0.1, 0.4]\n"
             "[hold]\nturns = 'any'\n[[solid]]\nshape = 'sphere'\nradius_m = 0.008\n"
             "mass_kg = 0.17\ncolor = [0.8, 0.1, 0.1]\n",
             false);
  const std::vector<std::string> command{"simulate",
                                         (folder / "out").string(),
                                         "--quiet",
                                         "--object",
                                         (folder / "marble.toml").string() + ",ball",
                                         "--minutes",
                                         "0.2",
                                         "--label",
                                         "--tracker",
                                         "component",
                                         "--board-views",
                                         "8"};
  EXPECT_EQ(touchtrace(command), 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/marble.labels.h5"));
  EXPECT_GT(read_labels(folder / "out/ball.labels.h5").time_s.size(), 100u);
}

TEST(SimulateCommand, GloveModelsHaveOtherReadingsAtRest) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out.h5").string();
  const auto baseline = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {out, "--overwrite"});
    EXPECT_EQ(simulate(options), 0);
    return RecordingReader(out).recording().gloves.at(0).info.baseline_counts.at(0);
  };
  // Five standard deviations among taxels.
  EXPECT_NEAR(baseline({}), 40.0, 30.0);
  EXPECT_NEAR(baseline({"--glove-model", "actionsense"}), 564.0, 15.0);
  EXPECT_NEAR(baseline({"--glove-model", "actionsense", "--set", "glove-baseline=100"}), 100.0,
              15.0);
}

TEST(SimulateCommand, ReadsOptionsFromAConfigurationFile) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  write_file(folder / "scene.toml",
             "[simulate]\noutput = \"" + out + "\"\nactivity = \"throw\"\nobject = \"ball,egg\"\n",
             false);
  ASSERT_EQ(simulate({"--config", (folder / "scene.toml").string()}), 0);
  EXPECT_EQ(RecordingReader(folder / "out/egg.h5").recording().activity, "throw");
}

TEST(SimulateCommand, RejectsInvalidObjects) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  EXPECT_EQ(simulate({out, "--object", "ball,bal"}), 2);
  EXPECT_EQ(simulate({out, "--object", "ball,"}), 2);
  EXPECT_EQ(simulate({out, "--object", "ball,seen"}), 2);  // twice
  EXPECT_EQ(simulate({out, "--object", "hammer", "--activity", "throw"}), 2);
  write_file(folder / "bad.toml", "mass_kg = nan\n", false);
  EXPECT_EQ(simulate({out, "--object", (folder / "bad.toml").string()}), 3);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace touchtrace
