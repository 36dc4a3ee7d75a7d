#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calib/smooth/robust_pass.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

constexpr double window_points = 2.5;  // deviation of the window
constexpr int reach_points = 10;
/// An interval counts with its three orders; a share of the mean of all as one interval.
constexpr double interval_weight = 3.0, prior_weight = 3.0;

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

Jerks averaged(const Jerks& expected, const Eigen::Matrix3d& usual) {
  Jerks result;
  const int count = static_cast<int>(expected.size());
  for (int k = 0; k < count; ++k) {
    Eigen::Matrix3d sum = prior_weight * usual;
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

/// -log of the likelihood, with Cauchy's loss, of a measurement that `state` does not know.
double surprise(const TrackPoint& point, const MotionState& state,
                const MotionNoise<double>& noise) {
  const Eigen::Matrix3d foretold = state.covariance.topLeftCorner<3, 3>();
  Eigen::Matrix3d variance = foretold;
  variance.diagonal() += std::pow(noise.measurement_scale, 2) * point.sigma_m.cwiseAbs2();
  const Eigen::LLT<Eigen::Matrix3d> root(variance);
  const double square = root.matrixL().solve(point.position_m - state.position_m).squaredNorm();
  return 0.5 * cauchy_loss(square) + root.matrixLLT().diagonal().array().log().sum();
}

/// Every `count`-th measurement, beginning with number `first`.
struct Fold {
  std::size_t first, count;
  bool holds(std::size_t i) const { return i % count == first; }
};

/// The tracks without the measurements of a fold, nor any jerk, which may know of these.
std::vector<WeightedTrack> without(const std::vector<WeightedTrack>& tracks, Fold fold) {
  std::vector<WeightedTrack> rest;
  for (const auto& track : tracks) {
    rest.push_back({{}, {}, track.flights});
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      if (fold.holds(i)) continue;
      rest.back().points.push_back(track.points[i]);
      rest.back().weights.push_back(track.weights[i]);
    }
  }
  return rest;
}

/// [the fold's measurements in `tracks`] -log of the likelihood of each given `rest`, which is
/// without them; without the constant.
std::vector<double> predictive_costs(const std::vector<WeightedTrack>& rest,
                                     const std::vector<WeightedTrack>& tracks, Fold fold,
                                     const MotionNoise<double>& noise,
                                     const SmoothOptions& options) {
  std::vector<std::vector<double>> costs(tracks.size());
  parallel_for(tracks.size(), options.threads, [&](std::size_t k) {
    const auto trajectory = pass(rest[k], noise, options);
    const auto& points = tracks[k].points;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (fold.holds(i))
        costs[k].push_back(surprise(points[i], trajectory.smoothed(points[i].time_s), noise));
  });
  std::vector<double> all;
  for (const auto& of_track : costs) all.insert(all.end(), of_track.begin(), of_track.end());
  return all;
}

/// Whether a sum of costs is above another by more than the standard error of their difference.
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

void find_jerk(std::vector<WeightedTrack>& tracks, MotionNoise<double>& noise,
               const SmoothOptions& options, int rounds) {
  double count = 1.0;  // and one square that is as it was said to be: the scale stays above 0
  for (auto& track : tracks) {
    track.jerk.resize(track.points.size(), Eigen::Matrix3d::Identity());
    count += 3.0 * static_cast<double>(track.points.size());
  }
  for (int round = 0; round < rounds; ++round) {
    std::vector<Jerks> expected(tracks.size());
    std::vector<double> squares(tracks.size());
    parallel_for(tracks.size(), options.threads, [&](std::size_t i) {
      const auto trajectory = pass(tracks[i], noise, options);
      expected[i] = trajectory.expected_jerk();
      squares[i] = expected_squares(tracks[i], trajectory);
      if (options.robust) reweight(tracks[i], trajectory);
    });
    const Eigen::Matrix3d usual = noise.usual_jerk_share * mean_of(expected);
    for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].jerk = averaged(expected[i], usual);
    noise.measurement_scale *= std::sqrt(std::accumulate(squares.begin(), squares.end(), 1.0) /
                                         (options.robust ? robust_share * count : count));
  }
}

std::optional<double> best_jerk_share(const std::vector<WeightedTrack>& tracks,
                                      const MotionNoise<double>& constant,
                                      const SmoothOptions& options) {
  constexpr Fold left_out{2, 4};
  const auto rest = without(tracks, left_out);
  const std::array<std::optional<double>, 3> shares{std::nullopt, 0.3, 0.1};
  std::vector<std::vector<double>> costs;
  for (const auto& share : shares) {
    auto noise = constant;
    auto changing = rest;
    if (share) {
      noise.usual_jerk_share = *share;
      find_jerk(changing, noise, options, few_rounds);
    }
    costs.push_back(predictive_costs(changing, tracks, left_out, noise, options));
  }
  const auto& least = *std::ranges::min_element(costs, {}, [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  });
  std::size_t best = 0;
  while (is_clearly_above(costs[best], least)) ++best;
  return shares[best];
}

}  // namespace touchtrace
