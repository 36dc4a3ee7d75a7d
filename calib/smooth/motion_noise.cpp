#include <ceres/autodiff_first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/scaled_track.h"

namespace touchtrace {
namespace {

constexpr std::size_t fewest_points = 6;
constexpr double log_scale_deviation = 2.3;  // a factor of 10

/// -log likelihood as a function of log jerk density and log measurement scale.
class NoiseCost {
 public:
  NoiseCost(const std::vector<WeightedTrack>& tracks, const SmoothOptions& options,
            const MotionUnits& units)
      : noise_(units.scaled(options.noise)),
        gravity_(options.gravity_m_per_s2 / units.acceleration()),
        initial_(scaled(options.initial, units)) {
    for (const auto& track : tracks) {
      tracks_.emplace_back(track.points, track.weights, units);
      events_.push_back(contact_events(track.flights, track.points.front().time_s, units.time_s));
    }
  }

  template <class T>
  bool operator()(const T* log_noise, T* cost) const {
    using std::exp;
    MotionNoise<T> noise{exp(log_noise[0]),
                         exp(log_noise[1]),
                         noise_.flight_jerk_density,
                         noise_.flight_acceleration_m_per_s2,
                         noise_.landing_velocity_m_per_s,
                         noise_.landing_acceleration_m_per_s2};
    const T unlikely = log_noise[1] / log_scale_deviation;
    *cost = 0.5 * unlikely * unlikely;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      std::vector<ContactEvent<T>> events;
      for (const auto& event : events_[i]) events.push_back({T(event.time), event.release});
      *cost +=
          innovation_cost(tracks_[i], MotionPrior<T>(noise, std::move(events)), gravity_, initial_);
    }
    return true;
  }

 private:
  MotionNoise<double> noise_;
  Eigen::Vector3d gravity_;
  InitialMotion initial_;
  std::vector<ScaledTrack> tracks_;
  std::vector<std::vector<ContactEvent<double>>> events_;
};

/// The best decade of the jerk density, as a start: the likelihood has more than one maximum.
double best_log_density(const NoiseCost& cost) {
  double best = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (int decade = -12; decade <= 24; ++decade) {
    const double at[] = {decade * std::log(10.0), 0.0};
    double value;
    cost(at, &value);
    if (value < lowest) lowest = value, best = at[0];
  }
  return best;
}

}  // namespace

std::optional<MotionNoise<double>> most_likely_noise(const std::vector<WeightedTrack>& tracks,
                                                     const SmoothOptions& options) {
  std::vector<Track> points;
  std::size_t count = 0;
  for (const auto& track : tracks) points.push_back(track.points), count += track.points.size();
  if (count < fewest_points) return std::nullopt;

  const auto units = MotionUnits::of(points);
  auto* cost = new NoiseCost(tracks, options, units);
  double log_noise[] = {best_log_density(*cost), 0.0};
  const ceres::GradientProblem problem(new ceres::AutoDiffFirstOrderFunction<NoiseCost, 2>(cost));
  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.line_search_direction_type = ceres::BFGS;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solver, problem, log_noise, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;

  auto noise = units.scaled(options.noise);
  noise.jerk_density = std::exp(log_noise[0]);
  noise.measurement_scale = std::exp(log_noise[1]);
  return units.unscaled(noise);
}

}  // namespace touchtrace
