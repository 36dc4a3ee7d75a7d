// Times of releases and landings, and what a landing does to the velocity.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/smooth/find_flights.h"
#include "calib/smooth/smooth.h"
#include "engine/base/random.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

TEST(SmoothFlights, EstimatesReleaseAndLanding) {
  const auto motion = synthetic_throw(30.0, 1);
  const auto track = measure(motion, 20.0, 0.002, 1);
  auto guess = motion.flights;
  for (auto& flight : guess) flight.release_s += 0.03, flight.landing_s -= 0.03;
  const auto found = smooth({track}, {guess}, {}).tracks.front();
  ASSERT_EQ(found.flights.size(), motion.flights.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < guess.size(); ++i)
    squares += std::pow(found.flights[i].landing_s - motion.flights[i].landing_s, 2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(guess.size())), 0.015);
}

/// In so much noise a slow landing may have happened anywhere within 0.1 s.
TEST(SmoothFlights, EventTimeDistributionsCoverLongIntervals) {
  const auto motion = synthetic_throw(60.0, 1);
  const auto found =
      smooth({measure(motion, 20.0, 0.02, 1)}, {motion.flights}, {}).tracks.front().flights;
  ASSERT_EQ(found.size(), motion.flights.size());
  std::size_t num_wide = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double sigma_s = found[i].landing_distribution.sigma_s();
    if (sigma_s < 0.03) continue;
    ++num_wide;
    EXPECT_LT(std::abs(found[i].landing_s - motion.flights[i].landing_s), 2.0 * sigma_s) << i;
  }
  EXPECT_GE(num_wide, 2u);
}

TEST(SmoothFlights, ImpactTimeDistributionsAreCalibrated) {
  const auto motion = synthetic_pingpong(40.0, 1);
  auto guess = motion.flights;
  for (auto& flight : guess) flight.release_s += 0.02, flight.landing_s += 0.02;
  const auto track = measure(motion, 20.0, 0.002, 1);
  const auto found = smooth({track}, {guess}, {}).tracks.front();
  ASSERT_EQ(found.flights.size(), motion.flights.size());
  double squares = 0.0, expected = 0.0;
  for (std::size_t i = 0; i + 1 < found.flights.size(); ++i) {  // the last lands after the track
    expected += std::pow(found.flights[i].landing_distribution.sigma_s(), 2);
    squares += std::pow(found.flights[i].landing_s - motion.flights[i].landing_s, 2);
  }
  // about 85 impacts: standard error sqrt(2 / 85) = 0.15 of the ratio of variances; 3 of these,
  // plus the drag's nonlinearity
  EXPECT_GT(squares / expected, 0.5);
  EXPECT_LT(squares / expected, 1.7);
}

/// A ball that bounces is in no hand between its flights. About 40 hits: standard error
/// sqrt(2 / 40) = 0.22 of the ratio of variances; 3 of these. About 43 flights of 6 parameters:
/// sqrt(2 / 258) = 0.09 of the positions' NEES; 3 of these.
TEST(SmoothFlights, FlightsThatFollowAtOnceAreJoinedByHits) {
  const Eigen::Vector3d gravity = SmoothOptions().gravity_m_per_s2;
  for (const double rate_hz : {20.0, 60.0}) {
    const auto motion = synthetic_pingpong(20.0, 1);
    const auto track = measure(motion, rate_hz, 0.002, 1);
    const auto found = smooth({track}, {find_flights(track, gravity)}, {}).tracks.front();
    ASSERT_EQ(found.status, SmoothStatus::converged);
    double position_nees = 0.0, time_nees = 0.0;
    std::size_t hits = 0;
    for (std::size_t i = 0; i + 1 < found.flights.size(); ++i) {
      const auto& flight = found.flights[i];
      if (found.flights[i + 1].release_s > flight.landing_s) continue;
      const auto truth = std::ranges::min_element(motion.flights, {}, [&](const Flight& f) {
        return std::abs(f.landing_s - flight.landing_s);
      });
      time_nees += std::pow(
          (flight.landing_s - truth->landing_s) / flight.landing_distribution.sigma_s(), 2);
      ++hits;
    }
    for (const auto& point : track) {
      const auto state = found.smoothed(point.time_s);
      const Eigen::Vector3d error = state.position_m - motion.position_at(point.time_s);
      position_nees += error.dot(state.covariance.topLeftCorner<3, 3>().inverse() * error) / 3.0;
    }
    EXPECT_GE(hits, motion.flights.size() - 3) << rate_hz;
    EXPECT_LT(time_nees / static_cast<double>(hits), 1.7) << rate_hz;
    EXPECT_LT(position_nees / static_cast<double>(track.size()), 1.3) << rate_hz;
  }
}

TEST(SmoothFlights, AWrongMeasurementDoesNotSplitAFlight) {
  const auto motion = synthetic_throw(15.0, 3);
  auto track = measure(motion, 60.0, 0.002, 3);
  const auto& longest = *std::ranges::max_element(
      motion.flights, {}, [](const Flight& f) { return f.landing_s - f.release_s; });
  const double middle_s = 0.5 * (longest.release_s + longest.landing_s);
  std::ranges::lower_bound(track, middle_s, {}, &TrackPoint::time_s)->position_m.x() += 0.1;
  const auto guess = find_flights(track, SmoothOptions().gravity_m_per_s2);
  ASSERT_EQ(guess.size(), motion.flights.size() + 1);
  EXPECT_EQ(smooth({track}, {guess}, {}).tracks.front().flights.size(), motion.flights.size());
}

TEST(SmoothFlights, DropsImplausibleFlights) {
  const auto track = measure(synthetic_wave(10.0, 6), 20.0, 0.002, 6);
  const auto found = smooth({track}, {{{4.0, 4.3}}}, {}).tracks.front();
  EXPECT_TRUE(found.flights.empty());
}

/// A guess that takes two throws and the catch between them for one flight is dropped, and nothing
/// else.
TEST(SmoothFlights, OneWrongFlightDoesNotHideTheOthers) {
  const auto motion = synthetic_throw(15.0, 1);
  auto guess = motion.flights;
  guess[3].landing_s = guess[4].landing_s;
  guess.erase(guess.begin() + 4);
  const auto smoothed = smooth({measure(motion, 60.0, 0.005, 1)}, {guess}, {});
  EXPECT_EQ(smoothed.tracks.front().flights.size(), motion.flights.size() - 2);
  EXPECT_LT(smoothed.noise.wander_sigma_m, 0.003);
}

/// A ball whose landing nobody saw, as it was hidden, lies on the floor afterwards.
TEST(SmoothFlights, AFlightEndsInAGapNotAtTheEndOfTheTrack) {
  Track track;
  RandomStream random(1, "noise");
  for (int i = 0; i < 180; ++i) {
    const double t = i / 60.0;
    if (t > 0.7 && t < 1.6) continue;
    const Eigen::Vector3d noise_m(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d position_m(std::min(t, 0.8), t < 1.0 ? 4.9 * t * t - 3.0 * t : 0.75, 0.0);
    track.push_back({t, position_m + 0.002 * noise_m, Eigen::Vector3d::Constant(0.002)});
  }
  const auto found =
      smooth({track}, {find_flights(track, SmoothOptions().gravity_m_per_s2)}, {}).tracks.front();
  ASSERT_EQ(found.status, SmoothStatus::converged) << name_of(found.status);
  ASSERT_EQ(found.flights.size(), 1u);
  EXPECT_GT(found.flights[0].landing_s, 0.65);
  EXPECT_LT(found.flights[0].landing_s, 1.65);
}

/// A track that is cut out of the flights at both ends: there is no release and no landing to find.
TEST(SmoothFlights, TracksMayBeginAndEndInFlight) {
  const auto motion = synthetic_throw(15.0, 1);
  const auto middle_s = [&](std::size_t i) {
    return 0.5 * (motion.flights[i].release_s + motion.flights[i].landing_s);
  };
  double squares = 0.0;
  for (std::size_t first = 0; first + 2 < motion.flights.size(); ++first) {
    Track track = measure(motion, 60.0, 0.002, first);
    std::erase_if(track, [&](const TrackPoint& point) {
      return point.time_s < middle_s(first) || point.time_s > middle_s(first + 2);
    });
    const auto& flights = motion.flights;
    const auto found =
        smooth({track}, {{flights[first], flights[first + 1], flights[first + 2]}}, {})
            .tracks.front();
    ASSERT_EQ(found.flights.size(), 3u) << first;
    EXPECT_LE(found.flights.front().release_s, track.front().time_s) << first;
    EXPECT_GT(found.flights.back().landing_s, track.back().time_s) << first;
    EXPECT_TRUE(std::isinf(found.flights.front().release_distribution.sigma_s()));
    for (const double time_s : {track.front().time_s, track.back().time_s}) {
      const auto state = found.smoothed(time_s);
      const Eigen::Vector3d error = state.velocity_m_per_s - motion.velocity_at(time_s);
      squares += error.dot(state.covariance.block<3, 3>(3, 3).inverse() * error);
    }
  }
  // 6 (n - 2) squares of standard normal deviates, if n is the number of flights: 3 standard errors
  const double count = 6.0 * static_cast<double>(motion.flights.size() - 2);
  EXPECT_LT(squares / count, 1.0 + 3.0 * std::sqrt(2.0 / count));
}

}  // namespace
}  // namespace touchtrace
