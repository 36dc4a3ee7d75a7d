#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/label/states/flights.h"

namespace touchtrace::label {
namespace {

using Eigen::Vector3d;

const Vector3d tossed_gravity(0.0, 9.81, 0.0);  // the camera's y points down
constexpr double toss_frame_s = 0.05, toss_period_s = 2.0, toss_s = 0.45, tosses_s = 10.0;

/// Time since the last release; less than toss_s in flight.
double since_toss_s(double time_s) { return std::fmod(time_s, toss_period_s); }

/// Position of an object that is tossed 25 cm up every toss_period_s, and waved in between.
Vector3d tossed_position(double time_s) {
  const double t = since_toss_s(time_s);
  if (t < toss_s) return {0.0, -0.5 * 9.81 * t * (toss_s - t), 1.0};
  return {0.08 * std::sin(12.0 * (t - toss_s)), 0.0, 1.0};
}

Observation observed_at(const Vector3d& position_m) {
  Observation observed;
  observed.found = true;
  observed.position_m = position_m;
  observed.sigma_m.setConstant(0.001);
  return observed;
}

/// Track in which the hand stays `hand_m` from the object, even in flight.
ClipTrack tossed(double hand_m) {
  RandomStream random(1, "tosses");
  ClipTrack track;
  for (double t = 0.51; t < tosses_s; t += toss_frame_s) {
    const Vector3d noise(random.normal(), random.normal(), random.normal());
    track.time_s.push_back(t);
    track.object.push_back(observed_at(tossed_position(t) + 0.0005 * noise));
    track.hand.push_back(observed_at(tossed_position(t) + Vector3d(0.0, hand_m, 0.0)));
  }
  return track;
}

void expect_every_flight(const std::vector<Flight>& flights) {
  ASSERT_EQ(flights.size(), 4u);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const double release_s = static_cast<double>(i + 1) * toss_period_s;
    EXPECT_NEAR(flights[i].release_s, release_s, 0.06);
    EXPECT_NEAR(flights[i].landing_s, release_s + toss_s, 0.06);
  }
}

TEST(GuessFlights, FindsTossesThatTheHandFollows) {
  expect_every_flight(guess_flights(tossed(0.05), tossed_gravity));
}

TEST(GuessFlights, BridgesTheTimeOutsideTheImage) {
  ClipTrack track = tossed(0.05);
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    const double t = since_toss_s(track.time_s[i]);
    if (t > toss_s) continue;
    track.hand[i].position_m.y() += t > 0.17 ? 0.1 : 0.0;  // it does not follow
    track.object[i].found = t < 0.18 || t > 0.32;
  }
  for (const Flight& flight : guess_flights(track, tossed_gravity))
    EXPECT_GT(flight.landing_s - flight.release_s, 0.75 * toss_s);
  EXPECT_EQ(guess_flights(track, tossed_gravity).size(), 4u);
}

TEST(GuessFlights, FindsAnObjectAwayFromTheHand) {
  ClipTrack track = tossed(0.05);
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    const double t = since_toss_s(track.time_s[i]);
    if (t > toss_s) continue;
    track.hand[i].position_m.y() += 0.1;
    track.object[i].position_m.x() += i % 2 ? 0.02 : -0.02;  // no free fall
  }
  expect_every_flight(guess_flights(track, tossed_gravity));
}

TEST(GuessFlights, IsEmptyForAWavedObject) {
  ClipTrack track;
  for (double t = 0.0; t < tosses_s; t += toss_frame_s) {
    track.time_s.push_back(t);
    track.object.push_back(observed_at({0.1 * std::sin(9.0 * t), 0.08 * std::sin(8.0 * t), 1.0}));
    track.hand.push_back(
        observed_at({0.1 * std::sin(9.0 * t), 0.05 + 0.08 * std::sin(8.0 * t), 1.0}));
  }
  EXPECT_TRUE(guess_flights(track, tossed_gravity).empty());
}

TEST(GuessFlights, IsEmptyWithoutObservations) {
  EXPECT_TRUE(guess_flights({}, tossed_gravity).empty());
  ClipTrack lost = tossed(0.05);
  for (Observation& observed : lost.object) observed.found = false;
  EXPECT_TRUE(guess_flights(lost, tossed_gravity).empty());
}

TEST(GuessFlights, LeaveOutALongTimeAtRestAwayFromTheHand) {
  ClipTrack track;
  for (double t = 0.0; t < 6.0; t += toss_frame_s) {
    const bool is_apart = t < 2.0;
    track.time_s.push_back(t);
    track.object.push_back(observed_at({0.0, 0.0, 1.0}));
    track.hand.push_back(observed_at({0.0, is_apart ? 0.4 : 0.05, 1.0}));
  }
  EXPECT_TRUE(guess_flights(track, tossed_gravity).empty());
}

}  // namespace
}  // namespace touchtrace::label
