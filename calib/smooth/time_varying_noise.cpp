#include "calib/smooth/time_varying_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calib/smooth/robust_smoother.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

constexpr double window_sigma_points = 2.5;
constexpr int window_half_points = 10;
/// Number of orders that a step's expected covariance averages; the prior weighs as one step.
constexpr double step_weight = 3.0, prior_weight = 3.0;

using JerkCovariances = std::vector<Eigen::Matrix3d>;

bool is_known(const Eigen::Matrix3d& covariance) { return covariance.trace() > 0.0; }

/// Mean over all known steps; identity if there are none.
Eigen::Matrix3d mean_over_tracks(const std::vector<JerkCovariances>& tracks) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const auto& covariances : tracks)
    for (const auto& covariance : covariances) sum += covariance, count += is_known(covariance);
  return count > 0.0 ? Eigen::Matrix3d(sum / count) : Eigen::Matrix3d::Identity();
}

/// Gaussian moving average, shrunk towards `prior`.
JerkCovariances smooth_over_time(const JerkCovariances& expected, const Eigen::Matrix3d& prior) {
  JerkCovariances result;
  const int count = static_cast<int>(expected.size());
  for (int k = 0; k < count; ++k) {
    Eigen::Matrix3d sum = prior_weight * prior;
    double weights = prior_weight;
    for (int i = std::max(0, k - window_half_points);
         i <= std::min(count - 1, k + window_half_points); ++i) {
      const auto& covariance = expected[static_cast<std::size_t>(i)];
      if (!is_known(covariance)) continue;
      const double weight =
          step_weight * std::exp(-0.5 * std::pow((i - k) / window_sigma_points, 2));
      sum += weight * covariance, weights += weight;
    }
    result.push_back(sum / weights);
  }
  return result;
}

/// Sum over points and axes of the expected weighted squared whitened residual.
double expected_squared_residuals(const WeightedTrack& track, const Trajectory& trajectory) {
  double sum = 0.0;
  const auto predicted = trajectory.predicted_measurements();
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& [position_m, variance_m2, white_variance_m2] = predicted[i];
    const Eigen::Vector3d square =
        (position_m - track.points[i].position_m).cwiseAbs2() + variance_m2;
    sum += track.weights[i] * square.cwiseQuotient(white_variance_m2).sum();
  }
  return sum;
}

/// Robust negative log-likelihood of a held-out measurement given the predicted `state`, without
/// its constant.
double predictive_cost(const TrackPoint& point, const MotionState& state,
                       const MotionNoise<double>& noise) {
  Eigen::Matrix3d variance = state.covariance.topLeftCorner<3, 3>();
  variance.diagonal() += std::pow(noise.measurement_scale, 2) * point.sigma_m.cwiseAbs2();
  const Eigen::LLT<Eigen::Matrix3d> root(variance);
  const double square = root.matrixL().solve(point.position_m - state.position_m).squaredNorm();
  return 0.5 * cauchy_loss(square) + root.matrixLLT().diagonal().array().log().sum();
}

/// Every `stride`-th measurement, beginning with number `first`.
struct HeldOut {
  std::size_t first, stride;
  bool contains(std::size_t i) const { return i % stride == first; }
};

/// Tracks without the held-out measurements and without jerk covariances, which may depend on them.
std::vector<WeightedTrack> training_tracks(const std::vector<WeightedTrack>& tracks,
                                           HeldOut held_out) {
  std::vector<WeightedTrack> training;
  for (const auto& track : tracks) {
    training.push_back({{}, {}, track.flights});
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      if (held_out.contains(i)) continue;
      training.back().points.push_back(track.points[i]);
      training.back().weights.push_back(track.weights[i]);
    }
  }
  return training;
}

/// [held-out measurements of all tracks] predictive costs given `training`.
std::vector<double> predictive_costs(const std::vector<WeightedTrack>& training,
                                     const std::vector<WeightedTrack>& tracks, HeldOut held_out,
                                     const MotionNoise<double>& noise,
                                     const SmoothOptions& options) {
  std::vector<std::vector<double>> costs(tracks.size());
  parallel_for(tracks.size(), options.num_threads, [&](std::size_t k) {
    const auto trajectory = smooth_once(training[k], noise, options);
    const auto& points = tracks[k].points;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (held_out.contains(i))
        costs[k].push_back(
            predictive_cost(points[i], trajectory.smoothed(points[i].time_s), noise));
  });
  std::vector<double> all;
  for (const auto& of_track : costs) all.insert(all.end(), of_track.begin(), of_track.end());
  return all;
}

/// Whether the sum of `costs` exceeds that of `others` by more than the standard error of their
/// paired difference.
bool is_clearly_above(const std::vector<double>& costs, const std::vector<double>& others) {
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double difference = costs[i] - others[i];
    sum += difference, squares += difference * difference;
  }
  const double mean = sum / static_cast<double>(costs.size());
  return sum > std::sqrt(squares - sum * mean);
}

}  // namespace

void estimate_jerk_covariances(std::vector<WeightedTrack>& tracks, MotionNoise<double>& noise,
                               const SmoothOptions& options, int num_iterations) {
  double count = 1.0;  // one residual of expected size, so that the scale stays above 0
  for (auto& track : tracks) {
    track.jerk_covariance.resize(track.points.size(), Eigen::Matrix3d::Identity());
    count += 3.0 * static_cast<double>(track.points.size());
  }
  for (int iteration = 0; iteration < num_iterations; ++iteration) {
    std::vector<JerkCovariances> expected(tracks.size());
    std::vector<double> squares(tracks.size());
    parallel_for(tracks.size(), options.num_threads, [&](std::size_t i) {
      const auto trajectory = smooth_once(tracks[i], noise, options);
      expected[i] = trajectory.expected_jerk_covariances();
      squares[i] = expected_squared_residuals(tracks[i], trajectory);
      if (options.robust) reweight(tracks[i], trajectory);
    });
    const Eigen::Matrix3d prior = noise.prior_jerk_fraction * mean_over_tracks(expected);
    for (std::size_t i = 0; i < tracks.size(); ++i)
      tracks[i].jerk_covariance = smooth_over_time(expected[i], prior);
    noise.measurement_scale *= std::sqrt(std::accumulate(squares.begin(), squares.end(), 1.0) /
                                         (options.robust ? robust_variance_ratio * count : count));
  }
}

std::optional<double> select_prior_jerk_fraction(const std::vector<WeightedTrack>& tracks,
                                                 const MotionNoise<double>& constant_noise,
                                                 const SmoothOptions& options) {
  constexpr HeldOut held_out{2, 4};
  const auto training = training_tracks(tracks, held_out);
  const std::array<std::optional<double>, 3> by_variation{std::nullopt, 0.3, 0.1};
  std::vector<std::vector<double>> costs;
  for (const auto& fraction : by_variation) {
    auto noise = constant_noise;
    auto fitted = training;
    if (fraction) {
      noise.prior_jerk_fraction = *fraction;
      estimate_jerk_covariances(fitted, noise, options, few_iterations);
    }
    costs.push_back(predictive_costs(fitted, tracks, held_out, noise, options));
  }
  const auto& lowest = *std::ranges::min_element(costs, {}, [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  });
  std::size_t selected = 0;
  while (is_clearly_above(costs[selected], lowest)) ++selected;
  return by_variation[selected];
}

}  // namespace touchtrace
