#include <gtest/gtest.h>

#include <cmath>

#include "calib/smooth/smooth.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

MotionNoise<double> oscillator(double rad_per_s, double damping) {
  MotionNoise<double> noise;
  noise.jerk_density = 100.0;
  noise.oscillator_rad_per_s = rad_per_s;
  noise.oscillator_damping = damping;
  return noise;
}

/// Largest difference of a and b over the largest element of b.
double difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(DampedOscillator, IsWhiteJerkAtZeroFrequency) {
  for (double h : {1e-3, 0.05, 1.0}) {
    const auto slow = damped_oscillator(h, oscillator(1e-9, 0.5)), free = white_jerk(h, 100.0);
    EXPECT_LT(difference(slow.F, free.F), 1e-8) << h;
    EXPECT_LT(difference(slow.Q, free.Q), 1e-8) << h;
  }
}

TEST(DampedOscillator, ManyShortStepsEqualOneLongStep) {
  for (double damping : {0.1, 0.7, 3.0})
    for (double h : {0.05, 0.5, 5.0}) {
      const auto noise = oscillator(12.0, damping);
      Transition<double> composed;
      for (int i = 0; i < 1000; ++i) composed = composed.then(damped_oscillator(h / 1000, noise));
      const auto single = damped_oscillator(h, noise);
      EXPECT_LT(difference(single.F, composed.F), 1e-10) << damping << " " << h;
      EXPECT_LT(difference(single.Q, composed.Q), 1e-10) << damping << " " << h;
    }
}

TEST(DampedOscillator, MatchesTheClosedForm) {
  const double w = 12.0, z = 0.3, h = 0.4, d = w * std::sqrt(1.0 - z * z);
  const auto step = damped_oscillator(h, oscillator(w, z));
  // v'' = -w^2 v - 2 z w v' from v = 1, v' = 0
  const double expected = std::exp(-z * w * h) * (std::cos(d * h) + z * w / d * std::sin(d * h));
  EXPECT_NEAR(step.F(1, 1), expected, 1e-12);
}

/// Velocity is stationary: after many periods its variance is q / (4 z w^3).
TEST(DampedOscillator, ConvergesToTheStationaryVariance) {
  const auto step = damped_oscillator(100.0, oscillator(12.0, 0.5));
  EXPECT_NEAR(step.F(1, 1), 0.0, 1e-12);
  EXPECT_NEAR(step.Q(1, 1) / (100.0 / (4.0 * 0.5 * std::pow(12.0, 3))), 1.0, 1e-9);
}

/// v' = g - c v from v = 0 after a release, in one and in many steps.
TEST(FreeFlight, MatchesTheClosedFormWithDrag) {
  MotionNoise<double> noise;
  noise.flight_drag_per_s = 0.3;
  const MotionPrior<double> prior(noise, {{0.0, true}});
  const double g = 9.81, c = noise.flight_drag_per_s, h = 0.5;
  for (int steps : {1, 50}) {
    auto fall = prior.between(-1e-9, 0.0);
    for (int i = 0; i < steps; ++i)
      fall = fall.then(prior.between(h * i / steps, h * (i + 1) / steps));
    EXPECT_NEAR(fall.u[1] * g, g / c * (1.0 - std::exp(-c * h)), 1e-4) << steps;
    EXPECT_NEAR(fall.u[0] * g, g / c * (h - (1.0 - std::exp(-c * h)) / c), 1e-4) << steps;
  }
}

double causal_velocity_rms(const SyntheticMotion& motion, const SmoothedTrack& smoothed) {
  double sum = 0.0, count = 0.0;
  for (double t = 1.0; t < 19.0; t += 0.0667, ++count)
    sum += (smoothed.causal(t).velocity_m_per_s - motion.velocity_at(t)).squaredNorm();
  return std::sqrt(sum / count);
}

TEST(DampedOscillator, ImprovesCausalVelocities) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto motion = synthetic_wave(20.0, seed);
    const auto track = measure(motion, 20.0, 0.002, seed);
    const auto found = smooth(std::vector<Track>{track}, {}, {});
    SmoothOptions white_jerk;
    white_jerk.noise = found.noise;
    white_jerk.estimate_noise = false;
    EXPECT_LT(causal_velocity_rms(motion, found.tracks.front()),
              0.8 * causal_velocity_rms(motion, smooth(track, white_jerk)))
        << seed;
  }
}

}  // namespace
}  // namespace touchtrace
