#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calib/smooth/time_varying_noise.h"
#include "engine/base/random.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

constexpr double frame_s = 0.05, stated_m = 0.002, correlation_s = 0.3;

MotionNoise<double> correlated_noise() {
  MotionNoise<double> noise;
  noise.measurement_scale = 0.8;
  noise.correlated_scale = 0.6;
  noise.correlation_time_s = correlation_s;
  return noise;
}

/// Reference: normal equations of one axis over all knots (p, v, a, error). The excess of a
/// measurement's sigma over the median is white.
struct NormalEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;

  explicit NormalEquations(const Track& track, const MotionNoise<double>& noise)
      : information(Eigen::MatrixXd::Zero(size(track), size(track))),
        vector(Eigen::VectorXd::Zero(size(track))) {
    // the filter starts with 1000 sigmas of a measurement, in units of its time step
    constexpr double start_m = 1e3 * stated_m;
    information.diagonal().head<4>() << std::pow(start_m, -2), std::pow(start_m / frame_s, -2),
        std::pow(start_m / (frame_s * frame_s), -2), 1.0;
    vector[0] = track.front().position_m.x() / (start_m * start_m);
    for (std::size_t k = 0; k < track.size(); ++k) {
      measure(k, track[k], noise);
      if (k > 0) move(k, track[k].time_s - track[k - 1].time_s, noise);
    }
  }

 private:
  static Eigen::Index size(const Track& track) { return 4 * std::ssize(track); }

  void measure(std::size_t k, const TrackPoint& point, const MotionNoise<double>& noise) {
    const double sigma_m = point.sigma_m.x(), typical_m = std::min(sigma_m, stated_m);
    const Eigen::Vector4d h(1.0, 0.0, 0.0, noise.correlated_scale * typical_m);
    const double variance =
        std::pow(noise.measurement_scale * sigma_m, 2) +
        std::pow(noise.correlated_scale, 2) * (sigma_m * sigma_m - typical_m * typical_m);
    const auto at = 4 * static_cast<Eigen::Index>(k);
    information.block<4, 4>(at, at) += h * h.transpose() / variance;
    vector.segment<4>(at) += h * point.position_m.x() / variance;
  }

  void move(std::size_t k, double h_s, const MotionNoise<double>& noise) {
    const auto step = white_jerk(h_s, noise.jerk_density);
    const double decay = std::exp(-h_s / noise.correlation_time_s);
    Eigen::Matrix4d F = Eigen::Matrix4d::Zero(), Q = Eigen::Matrix4d::Zero();
    F.topLeftCorner<3, 3>() = step.F, F(3, 3) = decay;
    Q.topLeftCorner<3, 3>() = step.Q, Q(3, 3) = 1.0 - decay * decay;
    Eigen::Matrix<double, 4, 8> difference;
    difference << -F, Eigen::Matrix4d::Identity();
    const auto from = 4 * static_cast<Eigen::Index>(k - 1);
    information.block<8, 8>(from, from) += difference.transpose() * Q.inverse() * difference;
  }
};

Eigen::Vector3d draw_normal(RandomStream& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// Measures `motion` with white and correlated errors of total standard deviation `stated_m`.
/// `share`: correlated fraction of the variance.
Track measure_correlated(const SyntheticMotion& motion, double share, std::uint64_t seed) {
  RandomStream random(seed, "correlated errors");
  const auto normal = [&] { return draw_normal(random); };
  const double decay = std::exp(-frame_s / correlation_s);
  Eigen::Vector3d common = normal();
  auto track = measure(motion, 1.0 / frame_s, stated_m * std::sqrt(1.0 - share), seed);
  for (auto& point : track) {
    common = decay * common + std::sqrt(1.0 - decay * decay) * normal();
    point.position_m += stated_m * std::sqrt(share) * common;
    point.sigma_m.setConstant(stated_m);
  }
  return track;
}

TEST(CorrelatedErrors, MatchTheNormalEquations) {
  auto track = measure(synthetic_wave(1.0, 2), 1.0 / frame_s, stated_m, 2);
  track.erase(track.begin() + 7, track.begin() + 10);
  track[4].sigma_m *= 3.0;
  SmoothOptions options;
  options.estimate_noise = options.robust = false;
  options.noise = correlated_noise();
  const auto smoothed = smooth(track, options);
  const NormalEquations reference(track, options.noise);
  const Eigen::LDLT<Eigen::MatrixXd> solver(reference.information);
  const Eigen::VectorXd mean = solver.solve(reference.vector);
  const Eigen::MatrixXd covariance =
      solver.solve(Eigen::MatrixXd::Identity(mean.size(), mean.size()));
  for (std::size_t k = 0; k < track.size(); ++k) {
    const auto state = smoothed.smoothed(track[k].time_s);
    const auto at = 4 * static_cast<Eigen::Index>(k);
    EXPECT_NEAR(state.position_m.x(), mean[at], 1e-6 * stated_m) << k;
    EXPECT_NEAR(state.velocity_m_per_s.x(), mean[at + 1], 1e-6 * stated_m / frame_s) << k;
    EXPECT_NEAR(state.covariance(0, 0) / covariance(at, at), 1.0, 1e-6) << k;
    EXPECT_NEAR(state.covariance(3, 3) / covariance(at + 1, at + 1), 1.0, 1e-6) << k;
  }
}

TEST(CorrelatedErrors, AreDetectedFromUnexplainedVariance) {
  std::vector<Track> white, correlated;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const auto motion = synthetic_wave(20.0, seed);
    white.push_back(measure(motion, 1.0 / frame_s, stated_m, seed));
    correlated.push_back(measure_correlated(motion, 0.5, seed));
  }
  const std::vector<std::vector<Flight>> none(white.size());
  EXPECT_EQ(smooth(white, none, {}).noise.correlated_scale, 0.0);
  const auto noise = smooth(correlated, none, {}).noise;
  // 3600 innovations determine the scale to 1.2 %; the innovations of the correlated part, which
  // decays within 0.3 s, add a fifth of the white ones
  EXPECT_NEAR(noise.measurement_scale, std::sqrt(0.5), 0.08);
  EXPECT_NEAR(noise.correlated_scale, std::sqrt(0.5), 0.08);
}

/// Noise with 91 % of the stated variance correlated.
MotionNoise<double> mostly_correlated() {
  auto noise = correlated_noise();
  noise.measurement_scale = 0.3;
  noise.correlated_scale = std::sqrt(1.0 - 0.3 * 0.3);
  return noise;
}

TEST(CorrelatedErrors, WeightOfAnUncertainFrameUsesItsTotalSigma) {
  auto track = measure(synthetic_wave(3.0, 4), 1.0 / frame_s, 0.3 * stated_m, 4);
  for (auto& point : track) point.sigma_m.setConstant(stated_m);
  track[30].sigma_m *= 10.0;
  track[30].position_m.x() += 10.0 * stated_m;
  SmoothOptions options;
  options.estimate_noise = false;
  options.noise = mostly_correlated();
  const auto smoothed = smooth(track, options);
  // Cauchy weight, scale 4, of an error of one sigma; the neighbours predict the position to 0.2
  const auto weight = [](double sigmas) { return 1.0 / (1.0 + std::pow(sigmas / 4.0, 2)); };
  EXPECT_GT(smoothed.weights[30], weight(1.2));
  EXPECT_LT(smoothed.weights[30], weight(0.8));
}

TEST(CorrelatedErrors, UncertainFramesDoNotRaiseTheMeasurementScale) {
  const auto truth = mostly_correlated();
  std::vector<WeightedTrack> tracks;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    auto track =
        measure_correlated(synthetic_wave(20.0, seed), std::pow(truth.correlated_scale, 2), seed);
    RandomStream random(seed, "badly seen");
    for (std::size_t i = 0; i < track.size(); i += 3) {
      track[i].sigma_m *= 5.0;
      track[i].position_m += stated_m * std::sqrt(5.0 * 5.0 - 1.0) * draw_normal(random);
    }
    tracks.push_back({track, std::vector<double>(track.size(), 1.0), {}});
  }
  auto noise = truth;
  SmoothOptions options;
  options.robust = false;
  estimate_jerk_covariances(tracks, noise, options, enough_iterations);
  // 2400 white errors determine it to 1.5 %, and time-varying noise absorbs a little of them
  EXPECT_NEAR(noise.measurement_scale, truth.measurement_scale, 0.05);
}

TEST(CorrelatedErrors, MedianSigmaIsPerAxis) {
  auto track = measure(synthetic_wave(3.0, 5), 1.0 / frame_s, stated_m, 5), along = track;
  for (auto& point : track) point.sigma_m.setConstant(3.0 * stated_m);
  for (auto& point : along) point.sigma_m.z() = 3.0 * stated_m;
  SmoothOptions options;
  options.estimate_noise = options.robust = false;
  options.noise = correlated_noise();
  const auto all = smooth(track, options), depth = smooth(along, options);
  for (const auto& point : track) {
    const auto a = all.smoothed(point.time_s), b = depth.smoothed(point.time_s);
    EXPECT_NEAR(a.position_m.z(), b.position_m.z(), 1e-6 * stated_m) << point.time_s;
    EXPECT_NEAR(a.covariance(2, 2) / b.covariance(2, 2), 1.0, 1e-6) << point.time_s;
  }
}

}  // namespace
}  // namespace touchtrace
