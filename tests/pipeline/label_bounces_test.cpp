#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/label/states/error_budget.h"
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

TEST(SmoothBodies, FindsHitsOfABouncingBallToMilliseconds) {
  const std::vector<ClipTrack> tracks{bounced()};
  const SmoothedBodies bounces = smooth_bodies(tracks, gravity, Flights::find);
  ASSERT_EQ(bounces.object.tracks[0].status, SmoothStatus::converged);
  for (const Flight& flight : bounces.object.tracks[0].flights) {
    const double hits = flight.landing_s / flight_s;
    if (flight.landing_s < seconds - flight_s) {
      EXPECT_NEAR(hits, std::round(hits), 0.004 / flight_s);
    }
  }
  EXPECT_LT(error_m(bounces), 1.5 * sigma_m);
  EXPECT_GT(error_m(smooth_bodies(tracks, gravity, Flights::none)), 3.0 * error_m(bounces));
}

/// A delay of up to sigma may put a label on the other side of a hit; far from hits its error is
/// the delay times the velocity.
TEST(ErrorBudget, LatencyCoversTheJumpOfVelocityAtAHit) {
  const std::vector<ClipTrack> tracks{bounced()};
  const SmoothedBodies bodies = smooth_bodies(tracks, gravity, Flights::find);
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

}  // namespace
}  // namespace touchtrace::label
