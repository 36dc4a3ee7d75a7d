#include <ceres/autodiff_first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/scaled_track.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_points_for_noise = 6;
constexpr double prior_sigma = 2.3;        // of logarithms: a factor of 10
constexpr double min_scale = 1e-3;         // reached at rest, if all measurements are equal
constexpr double initial_frequency = 0.5;  // radians per time unit
constexpr double initial_damping = 0.5;

/// Numbers of parameters: jerk density and measurement scale; with frequency and damping; with drag
/// and landing velocity; with drag, throw density and throw duration.
constexpr int contact_parameters = 2, oscillator_parameters = 4, bouncing_parameters = 4,
              throw_parameters = 5;

/// Negative log-likelihood plus prior as a function of the parameters' logarithms relative to their
/// initial values. Errors are white here: correlated ones are estimated from the variance that
/// white ones leave unexplained.
class NoiseCost {
 public:
  NoiseCost(const std::vector<WeightedTrack>& tracks, const SmoothOptions& options,
            const MotionUnits& units, ContactModel model)
      : noise_(units.scaled(options.noise)),
        model_(model),
        num_threads_(options.num_threads),
        gravity_(options.gravity_m_per_s2 / units.acceleration()),
        initial_(scaled(options.initial, units)) {
    noise_.correlated_scale = 0.0;
    for (const auto& track : tracks) {
      tracks_.emplace_back(track, units);
      events_.push_back(contact_events(track.flights, track.points.front().time_s, units.time_s));
    }
  }

  template <class T>
  bool operator()(const T* log_noise, T* cost) const {
    const auto noise = this->noise(log_noise);
    std::vector<T> costs(tracks_.size());
    parallel_for(tracks_.size(), num_threads_, [&](std::size_t i) {
      std::vector<ContactEvent<T>> events;
      for (const auto& event : events_[i]) events.push_back({T(event.time), event.is_release});
      costs[i] = negative_log_likelihood_with<T, ErrorModel::white>(
          tracks_[i], MotionPrior<T>(noise, std::move(events)), gravity_, initial_);
    });
    *cost = std::accumulate(costs.begin(), costs.end(), T(0));
    for (int i = 1; i < num_parameters(); ++i)
      *cost += 0.5 * log_noise[i] * log_noise[i] / (prior_sigma * prior_sigma);
    return true;
  }

  int num_parameters() const {
    if (model_ == ContactModel::damped_oscillator) return oscillator_parameters;
    const auto is_empty = [](const auto& events) { return events.empty(); };
    if (std::ranges::all_of(events_, is_empty)) return contact_parameters;
    return noise_.is_bouncing() ? bouncing_parameters : throw_parameters;
  }

  template <class T>
  MotionNoise<T> noise(const T* log_noise) const {
    using std::exp;
    auto noise = noise_.template cast<T>();
    noise.jerk_density = exp(log_noise[0]);
    noise.measurement_scale = min_scale + exp(log_noise[1]);
    if (model_ == ContactModel::damped_oscillator) {
      noise.oscillator_rad_per_s = initial_frequency * exp(log_noise[2]);
      noise.oscillator_damping = initial_damping * exp(log_noise[3]);
    } else if (num_parameters() > contact_parameters) {
      noise.flight_drag_per_s *= exp(log_noise[2]);
      if (noise_.is_bouncing()) {
        noise.landing_velocity_sigma_m_per_s *= exp(log_noise[3]);
      } else {
        noise.throw_jerk_density *= exp(log_noise[3]);
        noise.throw_duration_s *= exp(log_noise[4]);
      }
    }
    return noise;
  }

 private:
  MotionNoise<double> noise_;
  ContactModel model_;
  int num_threads_;
  Eigen::Vector3d gravity_;
  InitialMotion initial_;
  std::vector<ScaledTrack> tracks_;
  std::vector<std::vector<ContactEvent<double>>> events_;
};

/// Best decade of the jerk density, as the start: the likelihood has several maxima.
double best_log_density(const NoiseCost& cost) {
  double best = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (int decade = -12; decade <= 24; ++decade) {
    const double at[throw_parameters] = {decade * std::log(10.0)};
    double value;
    cost(at, &value);
    if (value < lowest) lowest = value, best = at[0];
  }
  return best;
}

ceres::FirstOrderFunction* with_derivatives(NoiseCost* cost) {
  if (cost->num_parameters() == contact_parameters)
    return new ceres::AutoDiffFirstOrderFunction<NoiseCost, contact_parameters>(cost);
  static_assert(oscillator_parameters == bouncing_parameters);
  if (cost->num_parameters() == bouncing_parameters)
    return new ceres::AutoDiffFirstOrderFunction<NoiseCost, bouncing_parameters>(cost);
  return new ceres::AutoDiffFirstOrderFunction<NoiseCost, throw_parameters>(cost);
}

}  // namespace

std::optional<MotionNoise<double>> maximum_likelihood_noise(
    const std::vector<WeightedTrack>& tracks, const SmoothOptions& options, ContactModel model) {
  std::vector<Track> points;
  std::size_t count = 0;
  for (const auto& track : tracks) points.push_back(track.points), count += track.points.size();
  if (count < min_points_for_noise) return std::nullopt;

  const auto units = MotionUnits::of(points);
  auto* cost = new NoiseCost(tracks, options, units, model);
  double log_noise[throw_parameters] = {best_log_density(*cost)};
  const ceres::GradientProblem problem(with_derivatives(cost));
  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.line_search_direction_type = ceres::BFGS;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solver, problem, log_noise, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;

  return units.unscaled(cost->noise(log_noise));
}

}  // namespace touchtrace
