#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/minimize.h"
#include "calib/smooth/smooth.h"
#include "engine/base/random.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace {
namespace {

/// Largest difference of a and b over the largest element of b.
double difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(ContactStep, IsWhiteJerkWithoutBandwidth) {
  for (double h : {1e-3, 0.05, 1.0}) {
    const auto step = contact_step(h, 100.0, 0.0);
    Eigen::Matrix3d F, Q;
    F << 1.0, h, h * h / 2.0, 0.0, 1.0, h, 0.0, 0.0, 1.0;
    Q << std::pow(h, 5) / 20.0, std::pow(h, 4) / 8.0, std::pow(h, 3) / 6.0,  //
        std::pow(h, 4) / 8.0, std::pow(h, 3) / 3.0, h * h / 2.0,             //
        std::pow(h, 3) / 6.0, h * h / 2.0, h;
    EXPECT_LT(difference(step.F, F), 1e-14) << h;
    EXPECT_LT(difference(step.Q, 100.0 * Q), 1e-14) << h;
  }
}

TEST(ContactStep, ManyShortStepsEqualOneLongStep) {
  for (double bandwidth : {0.1, 12.0, 100.0})
    for (double h : {0.05, 0.5, 5.0}) {
      Transition<motion_size> composed;
      for (int i = 0; i < 1000; ++i)
        composed = composed.then(contact_step(h / 1000, 100.0, bandwidth));
      const auto single = contact_step(h, 100.0, bandwidth);
      EXPECT_LT(difference(single.F, composed.F), 1e-10) << bandwidth << " " << h;
      EXPECT_LT(difference(single.Q, composed.Q), 1e-10) << bandwidth << " " << h;
    }
}

/// After a long time the variances are q / (4 b^3) and q / (4 b).
TEST(ContactStep, ConvergesToTheStationaryVariances) {
  const auto step = contact_step(100.0, 100.0, 12.0);
  EXPECT_NEAR(step.F(1, 1), 0.0, 1e-12);
  EXPECT_NEAR(step.Q(1, 1) / (100.0 / (4.0 * std::pow(12.0, 3))), 1.0, 1e-9);
  EXPECT_NEAR(step.Q(2, 2) / (100.0 / (4.0 * 12.0)), 1.0, 1e-9);
}

/// v' = g - c v from v = 0 after a release, in one and in many steps.
TEST(FreeFlight, MatchesTheClosedFormWithDrag) {
  MotionNoise noise;
  noise.flight_drag_per_s = 0.3;
  const MotionPrior<StateModel::with_flights> prior(noise, {{0.0, true}});
  const double g = 9.81, c = noise.flight_drag_per_s, h = 0.5;
  for (int steps : {1, 50}) {
    auto fall = prior.between(-1e-9, 0.0);
    for (int i = 0; i < steps; ++i)
      fall = fall.then(prior.between(h * i / steps, h * (i + 1) / steps));
    EXPECT_NEAR(fall.u[1] * g, g / c * (1.0 - std::exp(-c * h)), 1e-4) << steps;
    EXPECT_NEAR(fall.u[0] * g, g / c * (h - (1.0 - std::exp(-c * h)) / c), 1e-4) << steps;
  }
}

/// The measured point's offset is constant in contact and has the stated variance from the release
/// to the end of the flight.
TEST(Wander, IsStationaryInFlightAndConstantInContact) {
  MotionNoise noise;
  noise.wander_sigma_m = 0.01;
  const MotionPrior<StateModel::with_flights> prior(noise, {{0.225, true}, {0.625, false}}, 0.2);
  const auto wander_after = [](const Eigen::Matrix2d& covariance, const auto& step) {
    const Eigen::Matrix2d F = step.F.template bottomRightCorner<2, 2>();
    return Eigen::Matrix2d(F * covariance * F.transpose() +
                           step.Q_fixed.template bottomRightCorner<2, 2>());
  };
  Eigen::Matrix2d covariance = prior.initial(1.0).Q_fixed.bottomRightCorner<2, 2>();
  for (int i = 0; i < 20; ++i) {
    const double t = 0.05 * i, later = t + 0.05;
    covariance = wander_after(covariance, prior.between(t, later));
    Eigen::Matrix2d expected = Eigen::Matrix2d::Zero();
    if (later > 0.225) expected(0, 0) = 1e-4;
    if (later > 0.225 && later < 0.625) expected(1, 1) = 1e-4;
    EXPECT_LT((covariance - expected).norm(), 1e-16) << t;
  }
}

/// Derivatives with respect to the process noise of single steps, against central differences.
TEST(LikelihoodGradient, MatchesDifferences) {
  for (const bool with_flights : {false, true}) {
    const auto motion = synthetic_throw(6.0, 1);
    const auto points = measure(motion, 20.0, 0.002, 1);
    RandomStream random(1, "curve");
    WeightedTrack track{points, std::vector<double>(points.size(), 1.0), {}};
    track.weights[7] = 0.2;
    if (with_flights) track.flights = motion.flights;
    track.curve = {0.0, 0.25, std::vector<double>(26)};
    for (double& value : track.curve.log_variance) value = random.normal();
    const auto units = MotionUnits::of({points});
    const auto noise = units.scaled({});
    const Eigen::Vector3d gravity(0.0, 9.81 / units.acceleration(), 0.0);
    ScaledTrack scaled(track, units);
    const auto gradient = likelihood_gradient(scaled, noise, gravity);
    EXPECT_NEAR(gradient.cost, negative_log_likelihood(scaled, noise, gravity), 1e-9);
    for (std::size_t i = 1; i < points.size(); i += 7) {
      constexpr double step = 1e-4;
      double difference = 0.0;
      for (const double sign : {1.0, -1.0}) {
        auto moved = scaled;
        moved.points[i].log_noise += sign * step;
        difference += sign * negative_log_likelihood(moved, noise, gravity) / (2.0 * step);
      }
      EXPECT_NEAR(gradient.by_log_noise[i], difference, 1e-5 * (1.0 + std::abs(difference))) << i;
    }
  }
}

/// The numeric gradient at the edge of the function's domain is infinite.
TEST(Minimize, SurvivesTheEdgeOfTheDomain) {
  const auto function = [](const double* x) {
    return x[0] > 1.0005 ? std::numeric_limits<double>::infinity() : std::pow(x[0] - 2.0, 2);
  };
  std::vector<double> x{0.0};
  minimize(with_numeric_gradient(function, 1, 1e-3, 1), x, 20);
  EXPECT_GT(x[0], 0.5);
  EXPECT_LE(x[0], 1.0005);
}

double velocity_rms(const SyntheticMotion& motion, const SmoothedTrack& smoothed) {
  double sum = 0.0, count = 0.0;
  for (double t = 1.0; t < 39.0; t += 0.0667, ++count)
    sum += (smoothed.smoothed(t).velocity_m_per_s - motion.velocity_at(t)).squaredNorm();
  return std::sqrt(sum / count);
}

/// `motion` times `size`, a function of time.
template <class Size>
void scale(SyntheticMotion& motion, const Size& size) {
  constexpr double step_s = SyntheticMotion::step_s;
  auto& position = motion.position_m;
  for (std::size_t i = 0; i < position.size(); ++i)
    position[i] *= size(step_s * static_cast<double>(i));
  for (std::size_t i = 1; i + 1 < position.size(); ++i)
    motion.velocity_m_per_s[i] = (position[i + 1] - position[i - 1]) / (2.0 * step_s);
}

/// Rest and motion in turns of 5 s: a constant process noise fits neither.
TEST(ProcessNoiseCurve, ImprovesVelocitiesOfMotionsWithRests) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    auto motion = synthetic_wave(40.0, seed);
    scale(motion, [](double time_s) {
      const double phase_s = std::fmod(time_s, 10.0),
                   part = std::clamp((std::min(phase_s, 15.0 - phase_s) - 5.0) / 0.3, 0.0, 1.0);
      return part * part * (3.0 - 2.0 * part);
    });
    const auto track = measure(motion, 20.0, 0.002, seed);
    const auto found = smooth(std::vector<Track>{track}, {}, {});
    SmoothOptions constant;
    constant.noise = found.noise, constant.estimate_noise = false;
    EXPECT_LT(velocity_rms(motion, found.tracks.front()),
              0.85 * velocity_rms(motion, smooth(track, constant)))
        << seed;
  }
}

/// A wave that swells for a second every 5 s, with rests between.
SyntheticMotion bursts(std::uint64_t seed) {
  auto motion = synthetic_wave(40.0, seed);
  scale(motion, [](double time_s) {
    const double phase_s = std::fmod(time_s, 5.0);
    return phase_s < 4.0 ? 0.0 : std::pow(std::sin(std::numbers::pi * phase_s), 2);
  });
  return motion;
}

/// Squared error of the velocities in the bursts over the stated covariance; 1 is right.
TEST(ProcessNoiseCurve, StatesTheVelocitiesErrorsInBursts) {
  double sum = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto motion = bursts(seed);
    const auto found = smooth(std::vector<Track>{measure(motion, 20.0, 0.002, seed)}, {}, {});
    for (double start_s = 4.1; start_s < 39.0; start_s += 5.0)
      for (double t = start_s; t < start_s + 0.8; t += 0.05, ++count) {
        const auto state = found.tracks.front().smoothed(t);
        const Eigen::Matrix3d covariance = state.covariance.block<3, 3>(3, 3);
        const Eigen::Vector3d error = state.velocity_m_per_s - motion.velocity_at(t);
        sum += error.dot(covariance.ldlt().solve(error)) / 3.0;
      }
  }
  EXPECT_LT(sum / count, 1.5);
}

}  // namespace
}  // namespace touchtrace
