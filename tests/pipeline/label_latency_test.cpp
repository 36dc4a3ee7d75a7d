#include <gtest/gtest.h>

#include <cmath>

#include "calib/smooth/smooth.h"
#include "engine/base/random.h"
#include "pipeline/label/states/contact_latency.h"
#include "pipeline/label/states/touch_latency.h"

namespace touchtrace::label {
namespace {

constexpr double glove_hz = 15.0, scan_s = 0.03, sensor_lag_s = 0.008, landing_sigma_s = 0.005;
constexpr int rows = 32, first_touched_row = 3, last_touched_row = 10, taxels = rows * rows;

struct Catch {
  double release_s, landing_s;
};

/// Catches about every 1.7 s.
std::vector<Catch> catches(int count, std::uint64_t seed) {
  RandomStream random(seed, "catches");
  std::vector<Catch> result;
  for (double t = 1.0; static_cast<int>(result.size()) < count; t += random.uniform(1.4, 2.0))
    result.push_back({t, t + random.uniform(0.3, 0.6)});
  return result;
}

/// Time since the object was caught; negative while it flies.
double held_s(const std::vector<Catch>& catches, double time_s) {
  double held = time_s;
  for (const auto& [release_s, landing_s] : catches)
    if (time_s >= release_s) held = time_s - landing_s;
  return held;
}

/// Glove on a hand that catches an object; `force_counts` 0: it feels nothing.
GloveStream glove_of(const std::vector<Catch>& catches, double force_counts, std::uint64_t seed) {
  RandomStream random(seed, "taxels");
  GloveStream glove;
  glove.info.rows = glove.info.cols = rows;
  glove.info.rate_hz = glove_hz, glove.info.scan_s = scan_s, glove.info.bits = 10;
  glove.info.baseline_counts.assign(taxels, 40.0f);
  glove.info.mask.assign(taxels, 1);
  const auto frames = static_cast<std::uint64_t>((catches.back().landing_s + 1.0) * glove_hz);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    glove.sequence.push_back(frame);
    for (int taxel = 0; taxel < taxels; ++taxel) {
      const int row = taxel / rows;
      const double end_s = static_cast<double>(frame) / glove_hz;
      const double held = held_s(catches, end_s - scan_s * (1.0 - (row + 0.5) / rows));
      const bool is_touched = held > 0.0 && row >= first_touched_row && row <= last_touched_row;
      const double force = is_touched ? force_counts * -std::expm1(-held / sensor_lag_s) : 0.0;
      glove.counts.push_back(static_cast<std::uint16_t>(40.0 + force + random.normal(0.0, 1.5)));
    }
  }
  return glove;
}

/// Timeline before the correction, at a camera rate of 20 Hz.
Timeline prior_timeline() {
  Timeline timeline;
  timeline.glove = ClockFit{};
  timeline.glove_scan_s = scan_s, timeline.glove_rate_hz = glove_hz;
  timeline.set_latency(0.1, 0.1 / std::sqrt(12.0));
  return timeline;
}

/// What a camera sees whose stamps are late by `latency_s`.
std::vector<SmoothedTrack> seen(const std::vector<Catch>& catches, double latency_s,
                                std::uint64_t seed) {
  RandomStream random(seed, "landings");
  std::vector<SmoothedTrack> tracks(1);
  const double shift_s = latency_s - prior_timeline().latency_s;
  for (const auto& [release_s, landing_s] : catches) {
    Flight flight{release_s + shift_s, landing_s + shift_s + random.normal(0.0, landing_sigma_s)};
    auto& times = flight.landing_distribution;
    times.time_s[0] = flight.landing_s - landing_sigma_s;
    times.time_s[1] = flight.landing_s + landing_sigma_s;
    times.probability[0] = times.probability[1] = 0.5;
    tracks[0].flights.push_back(flight);
  }
  return tracks;
}

std::optional<LatencyEstimate> estimate(double latency_s, int num_catches, std::uint64_t seed,
                                        double force_counts = 300.0) {
  const auto true_catches = catches(num_catches, seed);
  return latency_from_catches(glove_of(true_catches, force_counts, seed), prior_timeline(),
                              seen(true_catches, latency_s, seed));
}

/// Also a latency of more than two frame periods.
TEST(ContactLatency, IsFoundWithinItsUncertainty) {
  for (const double latency_s : {0.005, 0.02, 0.045, 0.12}) {
    double squares = 0.0;
    constexpr int num_seeds = 12;
    for (std::uint64_t seed = 1; seed <= num_seeds; ++seed) {
      const auto found = estimate(latency_s, 40, seed);
      ASSERT_TRUE(found) << latency_s;
      EXPECT_EQ(found->source, "40 catches");
      EXPECT_LT(found->sigma_s, 0.006);
      squares += std::pow((found->latency_s - latency_s) / found->sigma_s, 2);
    }
    // 99.9th percentile of chi-square with 12 degrees of freedom
    EXPECT_LT(squares, 32.9) << latency_s;
  }
}

TEST(ContactLatency, CatchesWithAnotherFirstContactAreOutvoted) {
  const auto true_catches = catches(40, 3);
  auto seen_catches = true_catches;
  for (std::size_t i = 0; i < seen_catches.size(); i += 8) seen_catches[i].landing_s -= 0.2;
  const auto found = latency_from_catches(glove_of(true_catches, 300.0, 3), prior_timeline(),
                                          seen(seen_catches, 0.02, 3));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->latency_s, 0.02, 3.0 * found->sigma_s);
}

/// A third of the hits were not found.
TEST(ContactLatency, ABodyThatIsMostlyHitTellsNothing) {
  const auto true_catches = catches(40, 3);
  auto tracks = seen(true_catches, 0.02, 3);
  auto& flights = tracks[0].flights;
  for (std::size_t i = 0; i + 1 < flights.size(); ++i)
    if (i % 3 > 0) flights[i].landing_s = flights[i + 1].release_s;
  EXPECT_FALSE(latency_from_catches(glove_of(true_catches, 300.0, 3), prior_timeline(), tracks));
}

TEST(ContactLatency, AGloveThatFeelsNothingTellsNothing) {
  EXPECT_FALSE(estimate(0.02, 40, 1, 0.0));
}

TEST(ContactLatency, NoCatchTellsNothing) {
  auto timeline = prior_timeline();
  timeline.set_latency(2.0, 2.0 / std::sqrt(12.0));  // of a camera at 1 Hz
  EXPECT_FALSE(latency_from_catches(glove_of(catches(1, 1), 300.0, 1), timeline, {}));
}

TEST(ContactLatency, OneCatchTellsNothing) { EXPECT_FALSE(estimate(0.02, 1, 1)); }

TEST(ContactLatency, AnUnknownReadOutTimeTellsNothing) {
  const auto true_catches = catches(40, 1);
  auto glove = glove_of(true_catches, 300.0, 1);
  glove.info.scan_s = 0.0;
  EXPECT_FALSE(latency_from_catches(glove, prior_timeline(), seen(true_catches, 0.02, 1)));
}

/// Motion of a hand along three axes with periods of 0.7 to 1.6 s.
Eigen::Vector3d hand_position_m(double time_s) {
  return {0.1 * std::sin(2.0 * M_PI * time_s / 1.6), 0.05 * std::sin(2.0 * M_PI * time_s / 0.7),
          0.08 * std::cos(2.0 * M_PI * time_s / 1.1)};
}
Eigen::Vector3d hand_acceleration(double time_s) {
  constexpr double step_s = 1e-3;
  return (hand_position_m(time_s + step_s) - 2.0 * hand_position_m(time_s) +
          hand_position_m(time_s - step_s)) /
         (step_s * step_s);
}

/// A hand that holds something for 70 s, seen with a latency and felt with the usual lag.
struct HeldObject {
  static constexpr double seconds = 70.0, camera_hz = 20.0, touch_lag_s = 0.01;
  GloveStream glove = glove_of(catches(1, 1), 0.0, 1);
  Timeline timeline = prior_timeline();
  std::vector<ClipTrack> tracks{1};
  std::vector<SmoothedTrack> hand;
  std::vector<LabelTime> times;

  HeldObject(double latency_s, double counts_per_m_per_s2, std::uint64_t seed) {
    RandomStream random(seed, "held object");
    Track track;
    for (double time_s = 0.0; time_s < seconds; time_s += 1.0 / camera_hz) {
      TrackPoint point;
      point.time_s = time_s + latency_s - timeline.latency_s;
      point.position_m = hand_position_m(time_s);
      for (double& value : point.position_m) value += 0.002 * random.normal();
      point.sigma_m.setConstant(0.002);
      track.push_back(point);
      tracks[0].time_s.push_back(point.time_s);
    }
    hand = smooth({track}, {}, {}).tracks;
    glove.sequence.clear(), glove.counts.clear();
    for (std::uint64_t frame = 0; frame < seconds * glove_hz; ++frame) {
      glove.sequence.push_back(frame);
      const double time_s = timeline.glove_time_s(frame);
      times.push_back({time_s, 0, static_cast<std::int64_t>(frame)});
      const Eigen::Vector3d load = hand_acceleration(time_s - touch_lag_s);
      for (int taxel = 0; taxel < taxels; ++taxel) {
        const double force = 200.0 + counts_per_m_per_s2 * load[taxel % 3];
        glove.counts.push_back(static_cast<std::uint16_t>(force + random.normal(0.0, 5.0)));
      }
    }
  }
  std::optional<LatencyEstimate> estimate() const {
    return latency_from_touch(glove, timeline, times, tracks, hand, {0.0, 9.81, 0.0});
  }
};

TEST(TouchLatency, IsFoundWithinItsUncertainty) {
  for (const double latency_s : {0.03, 0.1, 0.25}) {
    const auto found = HeldObject(latency_s, 10.0, 1).estimate();
    ASSERT_TRUE(found) << latency_s;
    EXPECT_EQ(found->source, "touch in 4 segments");
    // the lag is the usual one; what is left is noise
    EXPECT_NEAR(found->latency_s, latency_s, 0.005);
    EXPECT_NEAR(found->sigma_s, 0.0058, 0.003);
  }
}

TEST(TouchLatency, AGloveThatFeelsNothingShowsNone) {
  EXPECT_FALSE(HeldObject(0.1, 0.0, 1).estimate());
}

TEST(Timeline, SetLatencyMovesCameraTimesByTheDifference) {
  auto timeline = prior_timeline();
  timeline.camera_time_s = {1.0};
  timeline.set_latency(0.2, 0.003);
  EXPECT_DOUBLE_EQ(timeline.camera_time_s[0], 0.9);
}

}  // namespace
}  // namespace touchtrace::label
