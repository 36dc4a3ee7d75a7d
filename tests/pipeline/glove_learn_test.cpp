#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/random.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/glove/learn_glove.h"
#include "pipeline/acquire/glove/protocol.h"
#include "tests/support/command_line.h"

namespace touchtrace {
namespace {

constexpr int frames = 100, taxels = 32;

GloveInfo info() {
  GloveInfo info;
  info.rows = 4, info.cols = 8, info.bits = 10;
  return info;
}

/// Frames around 500 counts with noise of 2 counts; squeezed, taxels change by up to `change`.
/// Taxel 0 is stuck at 1023, taxel 1 never responds.
std::vector<std::uint16_t> glove_frames(double change) {
  RandomStream random(1, "learn");
  std::vector<std::uint16_t> counts;
  for (int i = 0; i < frames; ++i)
    for (int taxel = 0; taxel < taxels; ++taxel) {
      const double squeeze = taxel == 1 ? 0.0 : change * (i % 20) / 20.0;
      const double count = taxel == 0 ? 1023.0 : 500.0 + squeeze + 2.0 * random.normal();
      counts.push_back(static_cast<std::uint16_t>(std::clamp(std::round(count), 0.0, 1023.0)));
    }
  return counts;
}

TEST(LearnGlove, FindsPolarityBaselineNoiseAndDefects) {
  for (const int polarity : {1, -1}) {
    const auto learned = learn_glove(info(), glove_frames(0.0), glove_frames(300.0 * polarity));
    EXPECT_EQ(learned.polarity, polarity);
    EXPECT_NEAR(learned.baseline_counts[5], 500.0, 1.0);
    EXPECT_NEAR(learned.noise_counts, 2.0, 1.0);
    EXPECT_EQ(learned.dead_taxels, 2);
    EXPECT_EQ(learned.stuck_taxels, 1);
    EXPECT_TRUE(learned.faults().empty());
  }
}

TEST(LearnGlove, AGloveThatDoesNotRespondIsNotFit) {
  EXPECT_FALSE(learn_glove(info(), glove_frames(0.0), glove_frames(0.0)).faults().empty());
}

TEST(LearnGlove, AFrozenGloveIsNotFit) {
  const std::vector<std::uint16_t> frozen(frames * taxels, 500);
  const auto learned = learn_glove(info(), frozen, glove_frames(300.0));
  ASSERT_EQ(learned.faults().size(), 1u);
  EXPECT_NEAR(learned.repeated_frames, 0.99, 0.001);
}

TEST(LearnGlove, TooFewFramesAreAnError) {
  EXPECT_THROW(learn_glove(info(), {}, glove_frames(300.0)), Error);
  EXPECT_THROW(learn_glove(info(), glove_frames(0.0), {}), Error);
}

int run_glove(const std::string& port, const std::string& seconds) {
  return testing::run_touchtrace({"glove", "--learn", "--glove", port, "--protocol", "mit-rows",
                                  "--rows", "4", "--cols", "8", "--bits", "10", "--rate-hz", "20",
                                  "--speed", "0", "--seconds", seconds});
}

/// 5 s at rest and 5 s of squeezing at 20 Hz.
TEST(LearnGlove, CommandJudgesAStream) {
  const ScratchFolder folder;
  GloveStream glove;
  glove.info = info();
  glove.counts = glove_frames(0.0);
  const auto squeezed = glove_frames(-300.0);
  glove.counts.insert(glove.counts.end(), squeezed.begin(), squeezed.end());
  std::string bytes;
  for (std::size_t i = 0; i < 2 * frames; ++i) bytes += encode_mit_rows(glove, i);
  const std::string port = (folder.path() / "glove.bin").string();
  write_file(port, bytes, false);
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run_glove(port, "5"), 0);
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("polarity -1"), std::string::npos);
  EXPECT_EQ(run_glove(port, "60"), 3);  // too few frames
  write_file(port, std::string(10'000, 'x'), true);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run_glove(port, "5"), 3);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("check --protocol"), std::string::npos);
}

}  // namespace
}  // namespace touchtrace
