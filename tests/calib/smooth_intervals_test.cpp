#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "calib/smooth/smooth.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

/// Motion drawn from the prior, with its measurements.
struct PriorMotion {
  std::vector<Eigen::Matrix3d> states;  ///< [p v a, axes]
  Track track;
};

PriorMotion draw_motion(int frames, double jerk_density, double sigma_m, std::uint64_t seed) {
  RandomStream random(seed, "prior");
  const auto step = contact_step(0.05, jerk_density, 0.0);
  const Eigen::Matrix3d root = step.Q.llt().matrixL();
  Eigen::Matrix3d state = Eigen::Matrix3d::Zero(), noise;
  PriorMotion motion;
  for (int i = 0; i < frames; ++i) {
    for (auto& value : noise.reshaped()) value = random.normal();
    state = step.F * state + root * noise;
    const Eigen::Vector3d error(random.normal(), random.normal(), random.normal());
    motion.track.push_back(
        {0.05 * i, state.row(0).transpose() + sigma_m * error, Eigen::Vector3d::Constant(sigma_m)});
    motion.states.push_back(state);
  }
  return motion;
}

/// Estimated noise and calibration of the velocities' covariances.
struct Calibration {
  MotionNoise noise;
  double coverage = 0.0;  ///< fraction of velocities inside their 80 % intervals
  double nees = 0.0;      ///< normalised estimation error squared per axis; 1 if calibrated
};

Calibration smooth_motions(const std::vector<PriorMotion>& motions, const SmoothOptions& options) {
  std::vector<Track> tracks;
  for (const auto& motion : motions) tracks.push_back(motion.track);
  const auto smoothed = smooth(tracks, std::vector<std::vector<Flight>>(tracks.size()), options);
  Calibration found{smoothed.noise};
  double count = 0.0;
  for (std::size_t k = 0; k < tracks.size(); ++k)
    for (std::size_t i = 0; i < tracks[k].size(); ++i) {
      const auto estimate = smoothed.tracks[k].smoothed(tracks[k][i].time_s);
      const Eigen::Vector3d error =
          estimate.velocity_m_per_s - motions[k].states[i].row(1).transpose();
      const Eigen::Matrix3d covariance = estimate.covariance.block<3, 3>(3, 3);
      found.nees += error.dot(covariance.llt().solve(error));
      for (int axis = 0; axis < 3; ++axis, ++count)
        found.coverage += std::abs(error[axis]) < 1.28155 * std::sqrt(covariance(axis, axis));
    }
  found.nees /= count;
  found.coverage /= count;
  return found;
}

TEST(SmoothIntervals, AreCalibratedForMotionsOfThePrior) {
  std::vector<PriorMotion> motions;
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    motions.push_back(draw_motion(100, 100.0, 0.002, seed));
  SmoothOptions options;
  options.robust = false;
  const Calibration found = smooth_motions(motions, options);
  EXPECT_NEAR(found.noise.jerk_density, 100.0, 5.0);
  EXPECT_NEAR(found.noise.measurement_scale, 1.0, 0.03);
  // 12000 intervals, correlated over about 4: standard error sqrt(.8 .2 4 / 12000) = 0.7 %; 3 of
  // these
  EXPECT_NEAR(found.coverage, 0.80, 0.02);
}

TEST(SmoothIntervals, AreCalibratedWhereNoiseHidesMostOfTheMotion) {
  std::vector<PriorMotion> motions;
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    motions.push_back(draw_motion(200, 1.6, 0.001, seed));
  const Calibration found = smooth_motions(motions, {});
  // 1800 intervals, correlated over about 8: standard errors sqrt(.8 .2 8 / 1800) = 2.7 % and
  // sqrt(2 8 / 1800) = 0.1; 3 of these
  EXPECT_NEAR(found.coverage, 0.80, 0.08);
  EXPECT_NEAR(found.nees, 1.0, 0.3);
}

}  // namespace
}  // namespace touchtrace
