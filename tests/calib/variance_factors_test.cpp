#include "calib/smooth/variance_factors.h"

#include <gtest/gtest.h>

#include "calib/smooth/smooth.h"
#include "engine/base/random.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

/// Body at rest for `points` frames with errors of 1 mm and a stated sigma `stated` times that.
WeightedTrack resting_track(std::size_t points, double stated) {
  RandomStream random(1, "rest");
  WeightedTrack track{{}, std::vector<double>(points, 1.0), {}};
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d error(random.normal(), random.normal(), random.normal());
    track.points.push_back(
        {0.05 * static_cast<double>(i), 0.001 * error, Eigen::Vector3d::Constant(0.001 * stated)});
  }
  return track;
}

/// Factors of a track with nearly constant velocity. `flights` only determine phases.
VarianceFactors factors_of(WeightedTrack track, const std::vector<Flight>& flights = {}) {
  MotionNoise<double> noise;
  noise.jerk_density = 1e-6;
  const Trajectory trajectory(track, noise, Eigen::Vector3d::Zero(), {1.0, 1.0});
  track.flights = flights;
  VarianceFactors factors;
  factors.add(track, trajectory, 1.0);
  return factors;
}

// 1200 residuals: standard error sqrt(2 / 1200) = 4 % of a factor; 3 of these
constexpr std::size_t many = 400;
constexpr double tolerance = 0.12;

TEST(VarianceFactors, AreOneForCorrectNoise) {
  EXPECT_NEAR(factors_of(resting_track(many, 1.0)).at({}, 10.0), 1.0, tolerance);
}

TEST(VarianceFactors, MeasureOverstatedAndUnderstatedNoise) {
  EXPECT_NEAR(factors_of(resting_track(many, 1.25)).at({}, 10.0), 0.64, 0.64 * tolerance);
  EXPECT_NEAR(factors_of(resting_track(many, 0.5)).at({}, 10.0), 4.0, 4.0 * tolerance);
}

TEST(VarianceFactors, HaveALowerLimit) {
  EXPECT_DOUBLE_EQ(factors_of(resting_track(many, 10.0)).at({}, 10.0), 0.4);
}

TEST(VarianceFactors, AreOneForFewResiduals) {
  EXPECT_DOUBLE_EQ(factors_of(resting_track(30, 2.0)).at({}, 1.0), 1.0);
}

TEST(VarianceFactors, AreOneInFlightAndNotBelowOneBeforeIt) {
  const std::vector<Flight> flights{{10.0, 10.4}};
  const auto factors = factors_of(resting_track(many, 1.25), flights);
  for (const double time_s : {9.6, 9.98, 10.2, 10.6})
    EXPECT_DOUBLE_EQ(factors.at(flights, time_s), 1.0);
  for (const double time_s : {9.4, 10.8}) EXPECT_LT(factors.at(flights, time_s), 0.8);
}

TEST(VarianceFactors, ExceedOneBeforeFlightsWithLargeResiduals) {
  std::vector<Flight> flights;
  for (double release_s = 1.0; release_s < 19.0; release_s += 1.0)
    flights.push_back({release_s, release_s + 0.1});
  // about 450 residuals: standard error sqrt(2 / 450) = 7 %; 3 of these
  EXPECT_NEAR(factors_of(resting_track(many, 0.5), flights).at(flights, 9.7), 4.0, 0.84);
}

/// Normalised estimation error squared of velocities per axis; 1 if calibrated.
double velocity_nees(const SyntheticMotion& motion, const Track& track,
                     const SmoothedTrack& smoothed) {
  double sum = 0.0;
  for (const auto& point : track) {
    const auto state = smoothed.smoothed(point.time_s);
    const Eigen::Vector3d error = state.velocity_m_per_s - motion.velocity_at(point.time_s);
    sum += error.dot(Eigen::Matrix3d(state.covariance.block<3, 3>(3, 3)).llt().solve(error)) / 3.0;
  }
  return sum / static_cast<double>(track.size());
}

/// Strokes are smoother than white-noise jerk, which shows where positions are exact.
TEST(VarianceFactors, CalibrateVelocitiesOfStrokes) {
  const auto motion = synthetic_wave(60.0, 5);
  const auto track = measure(motion, 20.0, 0.0003, 5);
  auto smoothed = smooth(track, SmoothOptions{});
  // 3600 errors, correlated over about 8: standard error sqrt(2 8 / 3600) = 0.07; 3 of these
  EXPECT_NEAR(velocity_nees(motion, track, smoothed), 1.0, 0.21);
  smoothed.factors = {};
  EXPECT_LT(velocity_nees(motion, track, smoothed), 0.75);
}

}  // namespace
}  // namespace touchtrace
