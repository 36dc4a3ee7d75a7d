#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {
namespace {

constexpr double interval_s = 0.002;

GloveClock lossless() {
  GloveClock clock;
  clock.lost_share = 0.0;
  return clock;
}

/// Simulates control interval `i` under these forces.
void sense(Glove& glove, const std::vector<double>& force_n, int i) {
  std::vector<int> loaded(force_n.size());
  std::iota(loaded.begin(), loaded.end(), 0);
  glove.sense({force_n, loaded}, i * interval_s, interval_s);
}

/// A live taxel of glove 1 with a gain near 1.
std::size_t some_taxel() {
  const auto& gain = glove_traits(1).gain;
  for (std::size_t i = 0; i < gain.size(); ++i)
    if (std::abs(gain[i] - 1.0f) < 0.1f) return i;
  return 0;
}

TEST(SceneGlove, Has680TaxelsInDistinctCells) {
  std::set<int> cells;
  double palm_m2 = 0.0;
  for (const Taxel& taxel : hand_model().taxels) {
    cells.insert(taxel.cell());
    if (taxel.finger < 0) palm_m2 += taxel.area_m2;
  }
  EXPECT_EQ(hand_model().taxels.size(), 680u);
  EXPECT_EQ(cells.size(), 680u);
  EXPECT_NEAR(palm_m2, 0.090 * 0.084, 1e-12);
  const GloveInfo info = glove_info(1);
  EXPECT_EQ(std::accumulate(info.mask.begin(), info.mask.end(), 0), 680);
  for (int cell = 0; cell < info.taxels(); ++cell)
    EXPECT_EQ(std::isfinite(info.taxel_position_m[3 * cell]), info.mask[cell] == 1);
}

TEST(SceneGlove, TraitsDependOnTheInstanceNumberOnly) {
  EXPECT_EQ(&glove_traits(1), &glove_traits(1));
  EXPECT_NE(glove_traits(1).gain, glove_traits(2).gain);
  double dead = 0.0, log_square = 0.0;
  for (float gain : glove_traits(1).gain)
    if (gain == 0.0f)
      ++dead;
    else
      log_square += std::log(gain) * std::log(gain);
  // Four standard errors: of a binomial fraction, and of a standard deviation.
  EXPECT_NEAR(dead / 680.0, 0.02, 4.0 * std::sqrt(0.02 * 0.98 / 680.0));
  EXPECT_NEAR(std::sqrt(log_square / (680.0 - dead)), 0.25,
              4.0 * 0.25 / std::sqrt(2.0 * (680.0 - dead)));
}

TEST(SceneGlove, ReadsItsBaselineWithoutContact) {
  Glove glove(1, {}, lossless(), 5);
  const std::vector<double> force_n(680, 0.0);
  glove.start(0.0);
  for (int i = 1; i <= 500; ++i) sense(glove, force_n, i);
  const GloveStream stream = glove.take();
  ASSERT_GE(stream.frames(), 14u);
  double square = 0.0;
  for (std::size_t i = 0; i < stream.counts.size(); ++i)
    square += std::pow(stream.counts[i] - stream.info.baseline_counts[i % 1024], 2);
  const double deviation = std::sqrt(square / static_cast<double>(stream.counts.size()));
  const double expected = std::hypot(1.5, 1 / std::sqrt(12.0));  // noise and rounding
  // Four standard errors of a standard deviation of 14 x 1024 readings.
  EXPECT_NEAR(deviation, expected,
              4.0 * expected / std::sqrt(2.0 * static_cast<double>(stream.counts.size())));
}

/// Constant force F from time 0: F (1 - exp(-t / 5 ms)) by the lag; creep multiplies it by
/// 1.4^(sum_k (1 - exp(-t / T_k))), T = .1, 1 and 10 s.
TEST(SceneGlove, LoadsWithLagAndCreepAndSaturates) {
  const std::size_t taxel = some_taxel();
  const double applied_n = 0.8;
  Glove glove(1, {}, lossless(), 5);
  std::vector<double> force_n(680, 0.0);
  force_n[taxel] = applied_n;
  glove.start(0.0);
  for (int i = 1; i <= 3000; ++i) sense(glove, force_n, i);
  const GloveStream stream = glove.take();
  const GloveTraits& traits = glove_traits(1);
  const Taxel& where = hand_model().taxels[taxel];
  for (std::size_t frame : {1u, 10u, 60u}) {
    const double time_s = static_cast<double>(stream.sequence[frame]) / 15.0 +
                          stream.info.scan_s * where.row / glove_rows;
    const double drift =
        1 + 0.03 * std::sin(traits.drift_rad_per_s[taxel] * time_s + traits.drift_phase_rad[taxel]);
    double crept = 0.0;
    for (const double constant_s : {0.1, 1.0, 10.0}) crept += 1 - std::exp(-time_s / constant_s);
    const double sensed = traits.gain[taxel] * drift * applied_n * std::pow(1.4, crept);
    const double signal = sensed / (sensed + 1.7);
    const double expected =
        stream.info.baseline_counts[where.cell()] + 960.0 * signal / (1 + 0.012 * signal);
    // Five standard deviations of the noise, and half a count of rounding.
    EXPECT_NEAR(stream.counts[frame * 1024 + where.cell()], expected, 5.0 * 1.5 + 0.5) << frame;
  }
}

/// A release follows the force at once, whatever crept before; a press soon after it reads higher
/// than the first.
TEST(SceneGlove, CreepEndsWithTheContact) {
  const std::size_t taxel = some_taxel();
  const std::size_t cell = hand_model().taxels[taxel].cell();
  Glove glove(1, {}, lossless(), 5);
  std::vector<double> force_n(680, 0.0);
  glove.start(0.0);
  for (int i = 1; i <= 4500; ++i) {
    force_n[taxel] = i <= 2000 || i > 2500 ? 0.8 : 0.0;
    sense(glove, force_n, i);
  }
  const GloveStream stream = glove.take();
  const auto mean_counts = [&](double from_s, double to_s) {
    double sum = 0.0, frames = 0.0;
    for (std::size_t frame = 0; frame < stream.frames(); ++frame) {
      const double time_s = static_cast<double>(stream.sequence[frame]) / 15.0;
      if (time_s >= from_s && time_s < to_s) sum += stream.counts[frame * 1024 + cell], ++frames;
    }
    return sum / frames - stream.info.baseline_counts[cell];
  };
  // Five standard deviations of a mean over at least six frames, and of the baseline's rounding.
  EXPECT_NEAR(mean_counts(4.1, 4.9), 0.0, 5.0 * 1.5 / std::sqrt(6.0) + 0.5);
  EXPECT_GT(mean_counts(5.05, 5.5), 1.05 * mean_counts(0.05, 0.5));
}

TEST(SceneGlove, SequenceNumbersIncludePausesAndLostFrames) {
  SceneOptions options;
  const GloveClock clock = glove_clock(options);
  Glove glove(1, {}, clock, options.seed);
  const std::vector<double> force_n(680, 0.0);
  glove.start(0.0);
  for (int i = 1; i <= 30000; ++i) sense(glove, force_n, i);
  const GloveStream stream = glove.take();
  const double sent = static_cast<double>(stream.sequence.back() - stream.sequence.front() + 1);
  // Three standard errors of a binomial fraction.
  EXPECT_NEAR(1.0 - static_cast<double>(stream.frames()) / sent, clock.lost_share,
              3.0 * std::sqrt(clock.lost_share / sent));
  double mean_delay_s = 0.0;
  for (std::size_t i = 0; i < stream.frames(); ++i) {
    const double scanned_s = clock.first_frame_s +
                             static_cast<double>(stream.sequence[i]) / clock.rate_hz +
                             stream.info.scan_s;
    const double delay_s = stream.host_time_s[i] - scanned_s;
    EXPECT_GE(delay_s, clock.latency_s);
    mean_delay_s += delay_s / static_cast<double>(stream.frames());
    if (i > 0) {
      EXPECT_GT(stream.host_time_s[i], stream.host_time_s[i - 1]);
    }
  }
  // Four standard errors of an exponential mean; five standard deviations of the clock's rate.
  EXPECT_NEAR(mean_delay_s, clock.latency_s + clock.jitter_s,
              4.0 * clock.jitter_s / std::sqrt(static_cast<double>(stream.frames())));
  EXPECT_NEAR(clock.rate_hz, 15.0, 15.0 * 200e-6);
  EXPECT_GT(stream.sequence.front(), 100u);
}

TEST(SceneGlove, FramesDoNotDependOnTheStartOfRecording) {
  const GloveClock clock = lossless();
  const std::vector<double> force_n(680, 0.0);
  Glove early(1, {}, clock, 7), late(1, {}, clock, 7);
  early.start(0.0);
  late.start(1.0);
  for (int i = 1; i <= 1000; ++i) sense(early, force_n, i);
  for (int i = 501; i <= 1000; ++i) sense(late, force_n, i);
  const GloveStream all = early.take(), part = late.take();
  ASSERT_EQ(all.sequence.back(), part.sequence.back());
  EXPECT_TRUE(std::equal(part.counts.rbegin(), part.counts.rend(), all.counts.rbegin()));
}

}  // namespace
}  // namespace touchtrace::scene
