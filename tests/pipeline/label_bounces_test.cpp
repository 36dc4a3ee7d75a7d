#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/label/states/error_budget.h"
#include "pipeline/label/states/flights.h"
#include "pipeline/label/states/states.h"

namespace touchtrace::label {
namespace {

using Eigen::Vector3d;

const Vector3d gravity(0.0, 9.81, 0.0);  // the camera's y points down
constexpr double frame_interval_s = 0.05, flight_s = 0.4371, seconds = 8.0, sigma_m = 0.001;

/// Position of a ball that is hit every flight_s and swings slowly sideways.
Vector3d position(double time_s) {
  const double since_hit_s = std::fmod(time_s, flight_s);
  const double height_m = 0.5 * 9.81 * since_hit_s * (flight_s - since_hit_s);
  return {0.05 * std::sin(time_s), -height_m, 1.0};
}

ClipTrack bounced(double begin_s = 0.1, double end_s = seconds) {
  RandomStream random(1, "bounces");
  ClipTrack track;
  for (double t = begin_s; t < end_s; t += frame_interval_s) {
    Observation observed;
    observed.found = true;
    observed.sigma_m = Vector3d::Constant(sigma_m);
    observed.position_m =
        position(t) + sigma_m * Vector3d(random.normal(), random.normal(), random.normal());
    track.time_s.push_back(t);
    track.object.push_back(observed);
    observed.position_m = {0.0, 0.1, 1.0};
    track.hand.push_back(observed);
  }
  return track;
}

/// RMS position error of the smoothed object, also between frames.
double error_m(const SmoothedBodies& bodies) {
  double sum = 0.0;
  int count = 0;
  for (double t = 0.5; t < seconds - 0.5; t += 0.0131, ++count)
    sum += (bodies.object.tracks[0].smoothed(t).position_m - position(t)).squaredNorm();
  return std::sqrt(sum / count);
}

TEST(GuessBounces, SplitsAtTheLowestPositions) {
  const ClipTrack track = bounced();
  const auto flights = guess_bounces(track, gravity);
  const auto hits = static_cast<std::size_t>(seconds / flight_s);
  ASSERT_EQ(flights.size(), hits + 1);
  for (std::size_t i = 0; i < hits; ++i) {
    EXPECT_NEAR(flights[i].landing_s, static_cast<double>(i + 1) * flight_s, frame_interval_s);
    EXPECT_EQ(flights[i].landing_s, flights[i + 1].release_s);
  }
}

TEST(SmoothBodies, FindsHitsOfABouncingBallToMilliseconds) {
  const std::vector<ClipTrack> tracks{bounced()};
  const SmoothedBodies bounces = smooth_bodies(tracks, gravity, FlightSearch::bounces);
  ASSERT_EQ(bounces.object.tracks[0].status, SmoothStatus::converged);
  for (const Flight& flight : bounces.object.tracks[0].flights) {
    const double hits = flight.landing_s / flight_s;
    if (flight.landing_s < seconds - flight_s) {
      EXPECT_NEAR(hits, std::round(hits), 0.004 / flight_s);
    }
  }
  EXPECT_LT(error_m(bounces), 1.5 * sigma_m);
  EXPECT_GT(error_m(smooth_bodies(tracks, gravity, FlightSearch::throws)), 3.0 * error_m(bounces));
}

/// A delay of up to sigma may put a label on the other side of a hit; far from hits its error is
/// the delay times the velocity.
TEST(ErrorBudget, LatencyCoversTheJumpOfVelocityAtAHit) {
  const std::vector<ClipTrack> tracks{bounced()};
  const SmoothedBodies bodies = smooth_bodies(tracks, gravity, FlightSearch::bounces);
  const SmoothedTrack& smoothed = bodies.object.tracks[0];
  constexpr double latency_s = 0.01, jump_m_per_s = 9.81 * flight_s;
  const auto latency_sigma = [&](double time_s, Eigen::Index i) {
    auto budget =
        ErrorModel({}, latency_s).object(smoothed, time_s, tracks[0], bodies.object.noise);
    return std::sqrt(budget[ErrorSource::latency](i, i));
  };
  const double hit_s = 9.0 * flight_s;
  for (const double after_s : {-0.005, 0.005})
    EXPECT_GT(latency_sigma(hit_s + after_s, 4), 0.3 * jump_m_per_s) << after_s;
  const double middle_s = hit_s + 0.25 * flight_s;
  EXPECT_NEAR(latency_sigma(middle_s, 1), latency_s * 0.25 * jump_m_per_s,
              0.05 * latency_s * jump_m_per_s);
  EXPECT_NEAR(latency_sigma(middle_s, 4), latency_s * 9.81, 0.1 * latency_s * 9.81);
}

TEST(GuessBounces, FindsAHitWithOneFrameBeyondIt) {
  const double first_hit_s = flight_s, last_hit_s = 8.0 * flight_s;
  const double begin_s = first_hit_s - 0.02, end_s = last_hit_s + 0.03;
  const ClipTrack track = bounced(begin_s, end_s);
  ASSERT_GT(track.time_s.back(), last_hit_s);
  ASSERT_LT(track.time_s[track.time_s.size() - 2], last_hit_s);
  const auto flights = guess_bounces(track, gravity);
  ASSERT_EQ(flights.size(), 9u);
  EXPECT_NEAR(flights.front().landing_s, first_hit_s, 0.5 * frame_interval_s);
  EXPECT_NEAR(flights.back().release_s, last_hit_s, 0.5 * frame_interval_s);

  const auto bodies = smooth_bodies({track}, gravity, FlightSearch::bounces);
  const auto& smoothed = bodies.object.tracks[0];
  for (const double hit_s : {first_hit_s, last_hit_s})
    for (const double t : {hit_s - 0.01, hit_s + 0.01}) {
      const Vector3d velocity = (position(t + 1e-6) - position(t - 1e-6)) / 2e-6;
      const MotionState state = smoothed.smoothed(t);
      // 0.1 % of normal errors are beyond 3.3 standard deviations
      EXPECT_LT(std::abs((state.velocity_m_per_s - velocity).y()),
                3.3 * std::sqrt(state.covariance(4, 4)));
      EXPECT_LT((state.velocity_m_per_s - velocity).norm(), 0.2) << t - hit_s;
    }
}

TEST(GuessBounces, IgnoresAnUncertainFrameAtTheEnd) {
  ClipTrack track = bounced(0.1, 10.0 * flight_s);
  const auto flights = guess_bounces(track, gravity).size();
  track.object.back().position_m.y() -= 0.04;
  EXPECT_EQ(guess_bounces(track, gravity).size(), flights + 1);
  track.object.back().sigma_m.setConstant(0.01);
  EXPECT_EQ(guess_bounces(track, gravity).size(), flights);
}

/// Track of an object in a waving hand that is thrown for 0.4 s every 2 s.
ClipTrack waved_and_thrown() {
  ClipTrack track = bounced();
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    const double t = std::fmod(track.time_s[i], 2.0), h = t * (0.4 - t);
    track.object[i].position_m = t < 0.4 ? Vector3d(0.0, -0.5 * 9.81 * h, 1.0)
                                         : Vector3d(0.08 * std::sin(12.0 * t), 0.0, 1.0);
  }
  return track;
}

TEST(FreeFallFraction, SeparatesBouncesFromThrows) {
  EXPECT_GT(free_fall_fraction({bounced()}, gravity), 0.65);
  const double thrown = free_fall_fraction({waved_and_thrown()}, gravity);
  EXPECT_GT(thrown, 0.1);
  EXPECT_LT(thrown, 0.3);
  EXPECT_EQ(free_fall_fraction({}, gravity), 0.0);
}

TEST(GuessBounces, IsEmptyWithoutObservations) {
  EXPECT_TRUE(guess_bounces({}, gravity).empty());
  ClipTrack lost = bounced();
  for (Observation& observed : lost.object) observed.found = false;
  EXPECT_TRUE(guess_bounces(lost, gravity).empty());
}

}  // namespace
}  // namespace touchtrace::label
