#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

/// Glove with noise of 0 to 8 counts above its baseline, at 15 Hz, that is pressed once.
GloveStream resting_glove(int frames) {
  RandomStream random(5, "resting glove");
  GloveStream glove;
  glove.info.rows = 6, glove.info.cols = 5;
  glove.info.baseline_counts.assign(30, 20.0f);
  glove.info.mask.assign(30, 1);
  for (int i = 0; i < frames; ++i) {
    glove.sequence.push_back(static_cast<unsigned>(i));
    glove.host_time_s.push_back(i / 15.0);
    for (int taxel = 0; taxel < 30; ++taxel)
      glove.counts.push_back(static_cast<std::uint16_t>(20 + random.below(9)));
  }
  glove.counts[100] = 900;
  return glove;
}

/// Expects `warning` as the first one after `modify` changed a good glove.
template <class Modify>
void expect_warning(const std::string& warning, const Modify& modify) {
  GloveStream glove = resting_glove(200);
  modify(glove);
  const auto warnings = check_tactile(glove).warnings();
  ASSERT_FALSE(warnings.empty()) << warning;
  EXPECT_NE(warnings[0].find(warning), std::string::npos) << warnings[0];
}

TEST(TactileCheck, WarnsOfImplausibleGloves) {
  EXPECT_TRUE(check_tactile(resting_glove(200)).warnings().empty());
  expect_warning("mean pressure at rest is 53 % of the range", [](auto& g) {
    for (auto& count : g.counts) count = std::min(1023, count + 540);
  });
  expect_warning("10 % of the frames repeat the previous one, for up to 1.3 s", [](auto& g) {
    for (int i = 61; i < 80; ++i)
      std::copy_n(g.counts.begin() + 30 * 60, 30, g.counts.begin() + 30 * i);
  });
  expect_warning("5 of 30 taxels are stuck at saturation, 1 whole row", [](auto& g) {
    for (std::size_t i = 5; i < g.counts.size(); i += 30)
      std::fill_n(g.counts.begin() + static_cast<std::ptrdiff_t>(i), 5, 1023);
  });
  expect_warning("1 of every 2 frames are interpolated or repeated", [](auto& g) {
    for (std::size_t i = 30; i + 30 < g.counts.size(); i += 60)
      for (std::size_t t = i; t < i + 30; ++t)
        g.counts[t] = (g.counts[t - 30] + g.counts[t + 30]) / 2;
  });
  expect_warning("4 of 30 taxels never change", [](auto& g) {
    for (std::size_t i = 0; i < g.counts.size(); i += 30)
      std::fill_n(g.counts.begin() + static_cast<std::ptrdiff_t>(i), 4, 20);
  });
  expect_warning("6 of 30 taxels never change, 1 whole column", [](auto& g) {
    for (std::size_t i = 0; i < g.counts.size(); i += 5) g.counts[i] = 22;
  });
  expect_warning("2 of every 3 frames are interpolated or repeated", [](auto& g) {
    for (std::size_t i = 0; i + 120 < g.counts.size(); i += 90)
      for (std::size_t t = i; t < i + 30; ++t) {
        const int change = g.counts[t + 90] - g.counts[t];
        g.counts[t + 30] = static_cast<std::uint16_t>(g.counts[t] + change / 3);
        g.counts[t + 60] = static_cast<std::uint16_t>(g.counts[t] + 2 * change / 3);
      }
  });
  expect_warning("of the squared pressure is negative pressure", [](auto& g) {
    for (auto& baseline : g.info.baseline_counts) baseline = 500.0f;
    g.info.polarity = -1;
    for (std::size_t t = 0; t < g.counts.size(); ++t)
      g.counts[t] = static_cast<std::uint16_t>(t % 30 < 5 && t > 3000 ? 900 : g.counts[t] + 480);
  });
  expect_warning("the largest count is 1.4 % of the range", [](auto& g) { g.info.bits = 16; });
}

TEST(TactileCheck, CountsRepetitionsPerFrame) {
  for (const int factor : {1, 2, 3, 5, 7}) {
    GloveStream glove = resting_glove(210);
    for (std::size_t i = 0; i < 210; ++i)
      std::copy_n(glove.counts.begin() + std::ptrdiff_t(30 * (i - i % std::size_t(factor))), 30,
                  glove.counts.begin() + std::ptrdiff_t(30 * i));
    EXPECT_EQ(check_tactile(glove).upsampling, factor);
  }
}

TEST(TactileCheck, JumpsBetweenTrialsAreNoInterpolation) {
  GloveStream glove = resting_glove(420);
  for (std::size_t i = 0; i < glove.counts.size(); ++i)
    if (i / (30 * 42) % 2 == 1) glove.counts[i] += 500;
  EXPECT_EQ(check_tactile(glove).upsampling, 1);
}

/// Clipped counts at rest, of which one changes between frames 19 and 20 and back 40 frames later.
TEST(TactileCheck, FewChangesAreNoInterpolation) {
  GloveStream glove = resting_glove(200);
  std::ranges::fill(glove.counts, std::uint16_t{1023});
  for (std::size_t frame = 20; frame < 60; ++frame) glove.counts[30 * frame + 4] = 900;
  EXPECT_EQ(check_tactile(glove).upsampling, 1);
}

}  // namespace
}  // namespace touchtrace
