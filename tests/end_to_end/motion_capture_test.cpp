// A glove and tracks of motion capture, without a camera, become labels and a model.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::run_program;

constexpr double clip_s = 4.0, glove_hz = 20.0, track_hz = 100.0;
constexpr int clips = 3;
constexpr int num_taxels = 64, lost_frame = 30;

double swing_m(double time_s) { return 0.1 * std::sin(3.0 * time_s); }

/// 8 x 8 taxels, of which one frame is missing.
void write_glove(const std::filesystem::path& file) {
  std::ofstream table(file);
  table << "time_s";
  for (int taxel = 0; taxel < num_taxels; ++taxel) table << ",p" << taxel;
  for (int i = 0; i < clips * clip_s * glove_hz; ++i) {
    if (i == lost_frame) continue;
    table << fmt::format("\n{:.3f}", i / glove_hz);
    for (int taxel = 0; taxel < num_taxels; ++taxel)
      table << fmt::format(",{:.0f}", 500.0 + 900.0 * swing_m(i / glove_hz) * taxel);
  }
}

/// Without the samples of `gap_s`.
void write_track(const std::filesystem::path& file, double offset_m,
                 std::pair<double, double> gap_s = {0.0, 0.0}) {
  std::ofstream table(file);
  table << "time_s,x_m,y_m,z_m";
  for (int i = 0; i < clips * clip_s * track_hz; ++i)
    if (i / track_hz < gap_s.first || i / track_hz >= gap_s.second)
      table << fmt::format("\n{:.3f},{:.5f},{:.5f},1.0", i / track_hz,
                           offset_m + swing_m(i / track_hz), 0.5 * swing_m(i / track_hz));
}

TEST(MotionCapture, TrainsAModelWithoutACamera) {
  const auto folder = touchtrace::testing::scratch_folder();
  std::filesystem::create_directories(folder);
  const auto path = [&](const char* name) { return (folder / name).string(); };
  write_glove(path("touch.csv"));
  write_track(path("hand.csv"), 0.0);
  write_track(path("object.csv"), 0.08, {1.0, 2.2});  // 24 of 240 frames
  std::ofstream clip_table(path("clips.csv"));
  clip_table << "start_s,end_s,object\n";
  for (int clip = 0; clip < clips; ++clip)
    clip_table << fmt::format("{},{},ball\n", clip * clip_s, (clip + 1) * clip_s - 0.01);
  clip_table.close();
  const auto expect_done = [](const std::string& arguments) {
    const auto done = run_program(arguments);
    ASSERT_EQ(done.exit_code, 0) << arguments << "\n" << done.output;
  };
  expect_done("import --glove " + path("touch.csv") +
              " --rows 8 --polarity 1 --baseline 0 --clips " + path("clips.csv") + " --output " +
              path("a.h5"));
  expect_done("smooth " + path("hand.csv") + " " + path("object.csv") + " --sigma 0.001 --output " +
              path("smoothed"));
  const std::string script = std::string("/usr/bin/python3 ") + TOUCHTRACE_SOURCE_DIR +
                             "/scripts/write_labels.py " + path("a.h5") + " " +
                             path("a.labels.h5") + " " + path("smoothed/hand.csv") + " " +
                             path("smoothed/object.csv");
  ASSERT_EQ(std::system(script.c_str()), 0);
  const auto checked = run_program("check " + path("a.labels.h5"));
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_EQ(checked.output.find("warning"), std::string::npos) << checked.output;
  EXPECT_NE(checked.output.find("hand       lost 0.00 %"), std::string::npos) << checked.output;
  EXPECT_NE(checked.output.find("object     lost 10.00 %"), std::string::npos) << checked.output;
  EXPECT_NE(std::system((script + " 2>/dev/null").c_str()), 0) << "replaced the labels";
  const std::string swapped = std::string("/usr/bin/python3 ") + TOUCHTRACE_SOURCE_DIR +
                              "/scripts/write_labels.py --overwrite " + path("a.labels.h5") + " " +
                              path("a.h5") + " 2>/dev/null";
  EXPECT_NE(std::system(swapped.c_str()), 0);
  expect_done("check " + path("a.h5"));
  expect_done("train --recording " + path("a.h5") + " --updates 1 --steps 5 --window 3 --output " +
              path("a.safetensors"));
  std::filesystem::remove_all(folder);
}

}  // namespace
