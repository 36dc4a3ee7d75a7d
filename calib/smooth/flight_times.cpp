#include <ceres/autodiff_first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <utility>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/scaled_track.h"

namespace touchtrace {
namespace {

constexpr double grid_step_s = 0.01, margin_s = 0.35, shortest_flight_s = 0.04;
constexpr double curvature_step_s = 0.004, largest_deviation_s = 0.02;
constexpr int grid_half = 6;

/// The stretch of a track around one flight, with its weights.
WeightedTrack around(const WeightedTrack& track, const Flight& flight) {
  WeightedTrack window;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const double t = track.points[i].time_s;
    if (t < flight.release_s - margin_s || t > flight.landing_s + margin_s) continue;
    window.points.push_back(track.points[i]);
    window.weights.push_back(track.weights[i]);
  }
  return window;
}

/// -log likelihood of a stretch as a function of one flight's release and landing, in units of time
/// from the stretch's first point. The other flights stay as they are.
class FlightCost {
 public:
  FlightCost(const WeightedTrack& window, std::vector<Flight> before, std::vector<Flight> after,
             const MotionNoise<double>& noise, const SmoothOptions& options)
      : units_(MotionUnits::of({window.points})),
        track_(window.points, window.weights, units_),
        origin_s_(window.points.front().time_s),
        noise_(units_.scaled(noise)),
        gravity_(options.gravity_m_per_s2 / units_.acceleration()),
        initial_(scaled(options.initial, units_)),
        before_(contact_events(before, origin_s_, units_.time_s)),
        after_(contact_events(after, origin_s_, units_.time_s)) {}

  /// False for times out of order.
  template <class T>
  bool operator()(const T* times, T* cost) const {
    const T shortest(shortest_flight_s / units_.time_s);
    if (times[1] < times[0] + shortest || (!before_.empty() && times[0] < T(before_.back().time)) ||
        (!after_.empty() && T(after_.front().time) < times[1]))
      return false;
    *cost = with_events<T>({{times[0], true}, {times[1], false}});
    return true;
  }

  double without_flight() const { return with_events<double>({}); }
  double penalty() const { return std::log(3.0 * static_cast<double>(track_.size())); }
  double scaled_time(double time_s) const { return (time_s - origin_s_) / units_.time_s; }
  double time_s(double scaled) const { return origin_s_ + scaled * units_.time_s; }

 private:
  template <class T>
  T with_events(const std::vector<ContactEvent<T>>& own) const {
    std::vector<ContactEvent<T>> events;
    for (const auto& event : before_) events.push_back({T(event.time), event.release});
    events.insert(events.end(), own.begin(), own.end());
    for (const auto& event : after_) events.push_back({T(event.time), event.release});
    return innovation_cost(track_, MotionPrior<T>(noise_.cast<T>(), std::move(events)), gravity_,
                           initial_);
  }

  MotionUnits units_;
  ScaledTrack track_;
  double origin_s_;
  MotionNoise<double> noise_;
  Eigen::Vector3d gravity_;
  InitialMotion initial_;
  std::vector<ContactEvent<double>> before_, after_;
};

/// The best point of a grid around the guess; the likelihood has kinks where an event passes a
/// frame.
double search_grid(const FlightCost& cost, const Flight& guess, double* times) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = -grid_half; i <= grid_half; ++i)
    for (int j = -grid_half; j <= grid_half; ++j) {
      const double at[] = {cost.scaled_time(guess.release_s + i * grid_step_s),
                           cost.scaled_time(guess.landing_s + j * grid_step_s)};
      double value;
      if (cost(at, &value) && value < lowest) lowest = value, times[0] = at[0], times[1] = at[1];
    }
  return lowest;
}

/// Deviation of one event's time from the curvature of the likelihood over a few milliseconds.
double deviation(const FlightCost& cost, const double* times, int event) {
  const double unit_s = cost.time_s(1.0) - cost.time_s(0.0), step = curvature_step_s / unit_s;
  double here = 0.0, values[2] = {0.0, 0.0};
  bool valid = cost(times, &here);
  for (int side = 0; side < 2; ++side) {
    double at[] = {times[0], times[1]};
    at[event] += side == 0 ? -step : step;
    valid = valid && cost(at, &values[side]);
  }
  const double curvature = (values[0] + values[1] - 2.0 * here) / (step * step);
  const double largest = largest_deviation_s / unit_s;
  return unit_s *
         (valid && curvature > 0.0 ? std::min(largest, 1.0 / std::sqrt(curvature)) : largest);
}

/// The flight with its best times, or nothing if the data speak against it.
std::vector<Flight> refine(const WeightedTrack& track, const Flight& guess,
                           std::vector<Flight> before, std::vector<Flight> after,
                           const MotionNoise<double>& noise, const SmoothOptions& options) {
  const auto window = around(track, guess);
  if (window.points.size() < 3) return {};
  auto* cost = new FlightCost(window, std::move(before), std::move(after), noise, options);
  const ceres::GradientProblem problem(new ceres::AutoDiffFirstOrderFunction<FlightCost, 2>(cost));
  double times[2] = {0.0, 0.0};
  if (!(search_grid(*cost, guess, times) + cost->penalty() < cost->without_flight())) return {};

  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.line_search_direction_type = ceres::BFGS;
  solver.max_num_iterations = 20;
  ceres::GradientProblemSolver::Summary summary;
  double refined[2] = {times[0], times[1]};
  ceres::Solve(solver, problem, refined, &summary);
  if (summary.IsSolutionUsable()) std::copy_n(refined, 2, times);
  return {{cost->time_s(times[0]), cost->time_s(times[1]), deviation(*cost, times, 0),
           deviation(*cost, times, 1)}};
}

}  // namespace

std::vector<Flight> most_likely_flights(const WeightedTrack& track,
                                        const MotionNoise<double>& noise,
                                        const SmoothOptions& options) {
  std::vector<Flight> found;
  for (std::size_t i = 0; i < track.flights.size(); ++i) {
    const auto next = track.flights.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    const auto flight =
        refine(track, track.flights[i], found, {next, track.flights.end()}, noise, options);
    found.insert(found.end(), flight.begin(), flight.end());
  }
  return found;
}

}  // namespace touchtrace
