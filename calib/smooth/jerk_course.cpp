#include <cmath>
#include <numeric>

#include "calib/smooth/robust_pass.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

constexpr int rounds = 12;
constexpr double window_points = 2.5;  // deviation of the window
constexpr int reach_points = 10;
/// An interval counts with its three orders; the mean of all as one interval, at a tenth.
constexpr double interval_weight = 3.0, prior_weight = 3.0, prior_part = 0.1;

using Jerks = std::vector<Eigen::Matrix3d>;

bool is_known(const Eigen::Matrix3d& jerk) { return jerk.trace() > 0.0; }

/// The mean over all intervals; the identity if there are none.
Eigen::Matrix3d mean_of(const std::vector<Jerks>& tracks) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const auto& jerks : tracks)
    for (const auto& jerk : jerks) sum += jerk, count += is_known(jerk);
  return count > 0.0 ? Eigen::Matrix3d(sum / count) : Eigen::Matrix3d::Identity();
}

Jerks averaged(const Jerks& expected, const Eigen::Matrix3d& of_all) {
  Jerks result;
  const int count = static_cast<int>(expected.size());
  for (int k = 0; k < count; ++k) {
    Eigen::Matrix3d sum = prior_weight * prior_part * of_all;
    double weights = prior_weight;
    for (int i = std::max(0, k - reach_points); i <= std::min(count - 1, k + reach_points); ++i) {
      const auto& jerk = expected[static_cast<std::size_t>(i)];
      if (!is_known(jerk)) continue;
      const double weight = interval_weight * std::exp(-0.5 * std::pow((i - k) / window_points, 2));
      sum += weight * jerk, weights += weight;
    }
    result.push_back(sum / weights);
  }
  return result;
}

/// Sum over points and axes of the squared residual that is to be expected, in deviations.
double expected_squares(const WeightedTrack& track, const Trajectory& trajectory) {
  double sum = 0.0;
  const auto foretold = trajectory.foretold();
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& [position_m, variance_m2, own_variance_m2] = foretold[i];
    const Eigen::Vector3d square =
        (position_m - track.points[i].position_m).cwiseAbs2() + variance_m2;
    sum += track.weights[i] * square.cwiseQuotient(own_variance_m2).sum();
  }
  return sum;
}

}  // namespace

double predictive_cost(const std::vector<WeightedTrack>& tracks, const MotionNoise<double>& noise,
                       const SmoothOptions& options) {
  std::vector<double> costs(tracks.size());
  for_each_index(tracks.size(), options.threads, [&](std::size_t k) {
    const auto& track = tracks[k];
    const auto foretold = pass(track, noise, options).foretold();
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      const Eigen::Array3d variance = foretold[i].own_variance_m2.array() / track.weights[i];
      // what the measurement itself does not explain; rounding must not leave less than nothing
      const Eigen::Array3d left = (variance - foretold[i].variance_m2.array()).max(1e-6 * variance);
      const Eigen::Array3d residual = (track.points[i].position_m - foretold[i].position_m).array();
      costs[k] += 0.5 * (residual.square() / left + (variance.square() / left).log()).sum();
    }
  });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

void find_jerk(std::vector<WeightedTrack>& tracks, MotionNoise<double>& noise,
               const SmoothOptions& options) {
  double count = 1.0;  // and one square that is as it was said to be: the scale stays above 0
  for (auto& track : tracks) {
    track.jerk.resize(track.points.size(), Eigen::Matrix3d::Identity());
    count += 3.0 * static_cast<double>(track.points.size());
  }
  for (int round = 0; round < rounds; ++round) {
    std::vector<Jerks> expected(tracks.size());
    std::vector<double> squares(tracks.size());
    for_each_index(tracks.size(), options.threads, [&](std::size_t i) {
      const auto trajectory = pass(tracks[i], noise, options);
      expected[i] = trajectory.expected_jerk();
      squares[i] = expected_squares(tracks[i], trajectory);
      if (options.robust) reweight(tracks[i], trajectory);
    });
    const auto of_all = mean_of(expected);
    for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].jerk = averaged(expected[i], of_all);
    noise.measurement_scale *= std::sqrt(std::accumulate(squares.begin(), squares.end(), 1.0) /
                                         (options.robust ? robust_share * count : count));
  }
}

}  // namespace touchtrace
