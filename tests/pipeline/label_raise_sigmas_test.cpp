#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/label/states/states.h"

namespace touchtrace::label {
namespace {

/// Clip at 20 Hz with a hand at rest and an object that moves to and fro, measured with errors of
/// `error_m`; `jump_m`: distance of every other position of the object from its own.
ClipTrack measured_clip(double error_m, double jump_m) {
  ClipTrack track;
  RandomStream random(1, "errors");
  for (int i = 0; i < 100; ++i) {
    const double t = 0.05 * i;
    const auto observation = [&](double x, double noise_m) {
      Observation o;
      o.found = true;
      o.position_m = Eigen::Vector3d(x, 0.0, 1.0) +
                     noise_m * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      o.sigma_m.setConstant(0.0005);
      return o;
    };
    track.time_s.push_back(t);
    track.hand.push_back(observation(0.0, 0.0005));
    track.object.push_back(observation(0.1 * std::sin(t) + (i % 2) * jump_m, error_m));
  }
  return track;
}

TEST(RaiseSigmas, WherePositionsScatterFarMoreThanStated) {
  const Eigen::Vector3d gravity(0.0, 9.81, 0.0);
  std::vector tracks{measured_clip(0.008, 0.0)};
  auto bodies = smooth_bodies(tracks, gravity, Flights::none);
  ASSERT_EQ(bodies.object.tracks[0].status, SmoothStatus::inconsistent);
  ASSERT_TRUE(raise_sigmas(tracks, bodies));
  EXPECT_NEAR(tracks[0].object[0].sigma_m.x(), 0.008, 0.002);
  EXPECT_EQ(tracks[0].hand[0].sigma_m.x(), 0.0005);
  bodies = smooth_bodies(tracks, gravity, Flights::none);
  EXPECT_EQ(bodies.object.tracks[0].status, SmoothStatus::converged);
  EXPECT_FALSE(raise_sigmas(tracks, bodies));
}

TEST(RaiseSigmas, NotWhereAnotherBodyIsMeasured) {
  std::vector tracks{measured_clip(0.0005, 0.3)};
  const auto bodies = smooth_bodies(tracks, Eigen::Vector3d(0.0, 9.81, 0.0), Flights::none);
  EXPECT_FALSE(raise_sigmas(tracks, bodies));
}

}  // namespace
}  // namespace touchtrace::label
