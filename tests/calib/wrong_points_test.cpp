#include "calib/smooth/wrong_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

constexpr double duration_s = 40.0, sigma_m = 0.002;

/// Times 1.5 to 2.5 s apart.
std::vector<double> event_times(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> gap_s(1.5, 2.5);
  std::vector<double> times{0.0};
  while (times.back() < duration_s) times.push_back(times.back() + gap_s(random));
  return times;
}

/// Strokes of 30 cm between times at which the velocity is reversed at once.
SyntheticMotion mallet(const std::vector<double>& strikes_s) {
  SyntheticMotion motion;
  std::size_t next = 1;
  for (double t = 0.0; t <= duration_s; t += SyntheticMotion::step_s) {
    if (t > strikes_s[next]) ++next;
    const double from_s = strikes_s[next - 1], phase = (t - from_s) / (strikes_s[next] - from_s);
    motion.position_m.emplace_back(0.03 * std::sin(t), 0.3 * std::sin(std::numbers::pi * phase),
                                   0.0);
  }
  return motion;
}

/// RMS error of the positions at the measurements nearest to `times_s`, of a track of 20 Hz.
double rms_near(const std::vector<double>& times_s, const SyntheticMotion& motion,
                const Track& track) {
  constexpr double rate_hz = 20.0;
  const auto smoothed = smooth(std::vector<Track>{track}, {}, {}).tracks.front();
  double sum = 0.0, count = 0.0;
  for (const auto& point : track)
    for (const double at_s : times_s) {
      if (std::abs(point.time_s - at_s) > 0.5 / rate_hz) continue;
      const Eigen::Vector3d truth_m = motion.position_at(point.time_s);
      sum += (smoothed.smoothed(point.time_s).position_m - truth_m).squaredNorm(), ++count;
    }
  return std::sqrt(sum / count);
}

/// With all strikes as outliers: 12 to 13 mm.
TEST(WrongPoints, AreNotStrikes) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto times_s = event_times(seed);
    const auto motion = mallet(times_s);
    EXPECT_LT(rms_near(times_s, motion, measure(motion, 20.0, sigma_m, seed)), 0.011) << seed;
  }
}

/// RMS error of the positions of strokes in which `run` measurements in a row are 10 cm off, about
/// every 2 s.
double rms_with_wrong_runs(double rate_hz, std::size_t run, std::uint64_t seed) {
  const auto motion = mallet(event_times(seed));
  auto track = measure(motion, rate_hz, sigma_m, seed);
  for (const double at_s : event_times(100 + seed))
    for (std::size_t i = 0; at_s > 1.0 && at_s < duration_s - 1.0 && i < run; ++i)
      track[static_cast<std::size_t>(rate_hz * at_s) + i].position_m.z() += 0.1;
  const auto smoothed = smooth(std::vector<Track>{track}, {}, {}).tracks.front();
  double sum = 0.0;
  for (const auto& point : track)
    sum += (smoothed.smoothed(point.time_s).position_m - motion.position_at(point.time_s))
               .squaredNorm();
  return std::sqrt(sum / static_cast<double>(track.size()));
}

/// With all runs taken for motion: 19 to 21 mm of six, 6 mm of three in one of the tracks.
TEST(WrongPoints, AreIgnored) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    EXPECT_LT(rms_with_wrong_runs(20.0, 1, seed), 0.0045) << seed;
    EXPECT_LT(rms_with_wrong_runs(60.0, 3, seed), 0.003) << seed;
    EXPECT_LT(rms_with_wrong_runs(60.0, 6, seed), 0.012) << seed;
  }
}

}  // namespace
}  // namespace touchtrace
