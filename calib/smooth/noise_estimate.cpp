#include "calib/smooth/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/minimize.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_points_for_noise = 6;
/// Points of long tracks from which the noise is estimated, and their number in each stretch.
constexpr std::size_t max_points = 20'000, stretch_points = 1000;
constexpr double numeric_step = 1e-3;  // of logarithms
constexpr int max_iterations = 60;

/// Parameter of the search: the logarithm of a value over its prior median, or a value less its
/// prior mean, with the standard deviation of its normal prior.
struct Parameter {
  double MotionNoise::*value;
  double prior_sigma;
  bool is_logarithm = true;

  double to_search(const MotionNoise& noise, const MotionNoise& centre) const {
    return is_logarithm ? std::log(noise.*value / (centre.*value)) : noise.*value - centre.*value;
  }
  double from_search(double x, const MotionNoise& centre) const {
    return is_logarithm ? centre.*value * std::exp(x) : centre.*value + x;
  }
};

/// A factor of 10 where nothing better is known.
constexpr double wide = 2.3;
/// A factor of 1000 for the jerk density. The likelihood is flat towards 0 for a body at rest,
/// which would make its velocity certain.
constexpr double very_wide = 6.9;
/// Tracks come with standard deviations: these are held near what is stated.
constexpr double scale_sigma = 0.5;
/// Measurements without any error would make it 0.
constexpr double min_scale = 0.01;
constexpr double fraction_sigma = 0.5;
/// Prior median of the bandwidth, in radians per interval between measurements.
constexpr double bandwidth_per_point = 0.2;

std::vector<Parameter> parameters(bool has_flights) {
  std::vector<Parameter> all{{&MotionNoise::jerk_density, very_wide},
                             {&MotionNoise::bandwidth_rad_per_s, wide},
                             {&MotionNoise::measurement_scale, scale_sigma}};
  if (has_flights)
    all.insert(all.end(), {{&MotionNoise::flight_drag_per_s, wide},
                           {&MotionNoise::wander_sigma_m, wide},
                           {&MotionNoise::throw_density_ratio, wide},
                           {&MotionNoise::landing_velocity_sigma_m_per_s, wide},
                           {&MotionNoise::landing_velocity_fraction, fraction_sigma, false}});
  return all;
}

/// Negative log-likelihood of all tracks plus prior, as a function of the parameters.
class NoiseCost {
 public:
  NoiseCost(const std::vector<WeightedTrack>& tracks, const SmoothOptions& options)
      : units_(units_of(tracks)),
        centre_(units_.scaled(options.noise)),
        gravity_(options.gravity_m_per_s2 / units_.acceleration()),
        parameters_(parameters(std::ranges::any_of(
            tracks, [](const auto& track) { return !track.flights.empty(); }))) {
    for (const auto& track : tracks) tracks_.emplace_back(track, units_);
    centre_.jerk_density = 1.0, centre_.bandwidth_rad_per_s = bandwidth_per_point;
  }

  double operator()(const double* x) const {
    const auto noise = scaled_noise(x);
    double cost = 0.0;
    for (const auto& track : tracks_) cost += negative_log_likelihood(track, noise, gravity_);
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      cost += 0.5 * std::pow(x[i] / parameters_[i].prior_sigma, 2);
    return cost;
  }

  std::vector<double> to_search(const MotionNoise& noise) const {
    std::vector<double> x;
    for (const auto& parameter : parameters_)
      x.push_back(parameter.to_search(units_.scaled(noise), centre_));
    return x;
  }

  MotionNoise noise(const double* x) const { return units_.unscaled(scaled_noise(x)); }

 private:
  static MotionUnits units_of(const std::vector<WeightedTrack>& tracks) {
    std::vector<Track> points;
    for (const auto& track : tracks) points.push_back(track.points);
    return MotionUnits::of(points);
  }

  MotionNoise scaled_noise(const double* x) const {
    auto noise = centre_;
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      noise.*parameters_[i].value = parameters_[i].from_search(x[i], centre_);
    noise.measurement_scale = std::max(noise.measurement_scale, min_scale);
    return noise;
  }

  MotionUnits units_;
  MotionNoise centre_;
  Eigen::Vector3d gravity_;
  std::vector<Parameter> parameters_;
  std::vector<ScaledTrack> tracks_;
};

std::size_t count_points(const std::vector<WeightedTrack>& tracks) {
  std::size_t count = 0;
  for (const auto& track : tracks) count += track.points.size();
  return count;
}

WeightedTrack stretch_of(const WeightedTrack& track, std::size_t first) {
  const std::size_t end = std::min(first + stretch_points, track.points.size());
  WeightedTrack stretch{{&track.points[first], &track.points[0] + end},
                        {&track.weights[first], &track.weights[0] + end},
                        {},
                        track.curve};
  const double start_s = stretch.points.front().time_s, end_s = stretch.points.back().time_s;
  std::ranges::copy_if(track.flights, std::back_inserter(stretch.flights), [&](const Flight& f) {
    return f.landing_s > start_s && f.release_s < end_s;
  });
  return stretch;
}

/// Tracks or stretches of long ones, evenly spaced: `max_points` or a few more of `count`.
std::vector<WeightedTrack> stretches_of(const std::vector<WeightedTrack>& tracks,
                                        std::size_t count) {
  std::vector<WeightedTrack> stretches;
  std::size_t seen = 0, kept = 0;
  for (const auto& track : tracks)
    for (std::size_t first = 0; first < track.points.size(); first += stretch_points) {
      const std::size_t size = std::min(stretch_points, track.points.size() - first);
      if (kept * count <= seen * max_points) {
        stretches.push_back(stretch_of(track, first));
        kept += size;
      }
      seen += size;
    }
  return stretches;
}

/// `x` with the best decade of the jerk density, as the start: the likelihood has several maxima.
std::vector<double> with_best_density(const NoiseCost& cost, std::vector<double> x,
                                      int num_threads) {
  constexpr int first_decade = -12, num_decades = 37;
  std::vector<double> costs(num_decades);
  const auto candidate = [&](std::size_t i) {
    auto at = x;
    at[0] = (first_decade + static_cast<int>(i)) * std::log(10.0);
    return at;
  };
  parallel_for(costs.size(), num_threads,
               [&](std::size_t i) { costs[i] = cost(candidate(i).data()); });
  return candidate(static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin()));
}

}  // namespace

std::optional<MotionNoise> estimate_noise(const std::vector<WeightedTrack>& tracks,
                                          const MotionNoise& start, const SmoothOptions& options) {
  const std::size_t count = count_points(tracks);
  if (count < min_points_for_noise) return std::nullopt;
  if (count > 2 * max_points) return estimate_noise(stretches_of(tracks, count), start, options);
  const bool has_curves = std::ranges::any_of(
      tracks, [](const auto& track) { return !track.curve.log_variance.empty(); });
  const NoiseCost cost(tracks, options);
  auto x = cost.to_search(start);
  if (!has_curves) x = with_best_density(cost, std::move(x), options.num_threads);
  const auto evaluate = with_numeric_gradient([&](const double* at) { return cost(at); }, x.size(),
                                              numeric_step, options.num_threads);
  if (!minimize(evaluate, x, max_iterations)) return std::nullopt;
  return cost.noise(x.data());
}

}  // namespace touchtrace
