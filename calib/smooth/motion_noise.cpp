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

constexpr std::size_t fewest_points = 6;
constexpr double log_deviation = 2.3;  // a factor of 10
constexpr double least_scale = 1e-3;   // of a body at rest, whose measurements are all the same
constexpr double usual_swing = 0.5, usual_damping = 0.5;

/// Jerk density, measurement scale and, of a swinging motion, frequency and damping, of one with
/// flights drag and how it is thrown, of a bouncing one drag and how unlike its hits are, as
/// logarithms of multiples of what is usual.
constexpr int of_any = 2, of_swinging = 4, of_bouncing = 4, of_thrown = 5;

/// -log likelihood as a function of these logarithms, if errors are white: what neighbours have in
/// common is told from what such errors leave.
class NoiseCost {
 public:
  NoiseCost(const std::vector<WeightedTrack>& tracks, const SmoothOptions& options,
            const MotionUnits& units, TouchedMotion motion)
      : noise_(units.scaled(options.noise)),
        motion_(motion),
        threads_(options.threads),
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
    parallel_for(tracks_.size(), threads_, [&](std::size_t i) {
      std::vector<ContactEvent<T>> events;
      for (const auto& event : events_[i]) events.push_back({T(event.time), event.release});
      costs[i] = innovation_cost_with<T, Errors::white>(
          tracks_[i], MotionPrior<T>(noise, std::move(events)), gravity_, initial_);
    });
    *cost = std::accumulate(costs.begin(), costs.end(), T(0));
    for (int i = 1; i < parameters(); ++i)
      *cost += 0.5 * log_noise[i] * log_noise[i] / (log_deviation * log_deviation);
    return true;
  }

  int parameters() const {
    if (motion_ == TouchedMotion::swinging) return of_swinging;
    const auto stays = [](const auto& events) { return events.empty(); };
    if (std::ranges::all_of(events_, stays)) return of_any;
    return noise_.bounces() ? of_bouncing : of_thrown;
  }

  template <class T>
  MotionNoise<T> noise(const T* log_noise) const {
    using std::exp;
    auto noise = noise_.template cast<T>();
    noise.jerk_density = exp(log_noise[0]);
    noise.measurement_scale = least_scale + exp(log_noise[1]);
    if (motion_ == TouchedMotion::swinging) {
      noise.swing_rad_per_s = usual_swing * exp(log_noise[2]);
      noise.swing_damping = usual_damping * exp(log_noise[3]);
    } else if (parameters() > of_any) {
      noise.flight_drag_per_s *= exp(log_noise[2]);
      if (noise_.bounces()) {
        noise.landing_velocity_m_per_s *= exp(log_noise[3]);
      } else {
        noise.throw_jerk_density *= exp(log_noise[3]);
        noise.throw_s *= exp(log_noise[4]);
      }
    }
    return noise;
  }

 private:
  MotionNoise<double> noise_;
  TouchedMotion motion_;
  int threads_;
  Eigen::Vector3d gravity_;
  InitialMotion initial_;
  std::vector<ScaledTrack> tracks_;
  std::vector<std::vector<ContactEvent<double>>> events_;
};

/// The best decade of the jerk density, as a start: the likelihood has more than one maximum.
double best_log_density(const NoiseCost& cost) {
  double best = 0.0, lowest = std::numeric_limits<double>::infinity();
  for (int decade = -12; decade <= 24; ++decade) {
    const double at[of_thrown] = {decade * std::log(10.0)};
    double value;
    cost(at, &value);
    if (value < lowest) lowest = value, best = at[0];
  }
  return best;
}

ceres::FirstOrderFunction* differentiated(NoiseCost* cost) {
  if (cost->parameters() == of_any)
    return new ceres::AutoDiffFirstOrderFunction<NoiseCost, of_any>(cost);
  static_assert(of_swinging == of_bouncing);
  if (cost->parameters() == of_bouncing)
    return new ceres::AutoDiffFirstOrderFunction<NoiseCost, of_bouncing>(cost);
  return new ceres::AutoDiffFirstOrderFunction<NoiseCost, of_thrown>(cost);
}

}  // namespace

std::optional<MotionNoise<double>> most_likely_noise(const std::vector<WeightedTrack>& tracks,
                                                     const SmoothOptions& options,
                                                     TouchedMotion motion) {
  std::vector<Track> points;
  std::size_t count = 0;
  for (const auto& track : tracks) points.push_back(track.points), count += track.points.size();
  if (count < fewest_points) return std::nullopt;

  const auto units = MotionUnits::of(points);
  auto* cost = new NoiseCost(tracks, options, units, motion);
  double log_noise[of_thrown] = {best_log_density(*cost)};
  const ceres::GradientProblem problem(differentiated(cost));
  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.line_search_direction_type = ceres::BFGS;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solver, problem, log_noise, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;

  return units.unscaled(cost->noise(log_noise));
}

}  // namespace touchtrace
