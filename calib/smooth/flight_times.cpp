#include <ceres/autodiff_first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "calib/smooth/likelihood.h"
#include "calib/smooth/scaled_track.h"

namespace touchtrace {
namespace {

constexpr double grid_step_s = 0.02, margin_s = 0.35, shortest_flight_s = 0.04;
constexpr int grid_half = 3;
constexpr std::size_t fewest_points_of_flight = 3;
constexpr double scan_step_s = 0.001, least_deviation_s = 1e-4;
constexpr int scan_half = 30;
/// Of likely times, in deviations: at this spacing the trapezoid rule is exact to 1e-15 for a bell,
/// and what lies beyond 4.5 is as good as impossible.
constexpr double spacing_deviations = 0.75;

/// The stretch of a track around one flight, with its weights. Its jerk stays out: found with the
/// times that are to be found, it would bear them out.
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
/// from the stretch's first point. The other flights stay as they are, but for one that begins
/// where this one lands: it goes on doing so. Where this one begins so itself, its release is not
/// free.
class FlightCost {
 public:
  FlightCost(const WeightedTrack& window, const MotionUnits& units, const Flight& flight,
             const std::vector<Flight>& before, const std::vector<Flight>& after,
             const MotionNoise<double>& noise, const SmoothOptions& options)
      : units_(units),
        track_(window, units_),
        origin_s_(window.points.front().time_s),
        noise_(units_.scaled(noise)),
        gravity_(options.gravity_m_per_s2 / units_.acceleration()),
        initial_(scaled(options.initial, units_)),
        before_(contact_events(before, origin_s_, units_.time_s)),
        after_(contact_events(after, origin_s_, units_.time_s)),
        begins_with_hit_(!before.empty() && flight.release_s <= before.back().landing_s),
        ends_with_hit_(!after.empty() && after.front().release_s <= flight.landing_s) {}

  bool release_is_free() const { return !begins_with_hit_; }

  /// False for times out of order.
  template <class T>
  bool operator()(const T* times, T* cost) const {
    const T release = begins_with_hit_ ? T(before_.back().time) : times[0], &landing = times[1];
    const auto next = static_cast<std::size_t>(ends_with_hit_);
    if (landing < release + T(shortest_flight_s / units_.time_s) ||
        (!before_.empty() && release < T(before_.back().time)) ||
        (next < after_.size() && T(after_[next].time) < landing))
      return false;
    *cost = with_events<T>({{release, true}, {landing, false}}, landing);
    return true;
  }

  double without_flight() const { return with_events<double>({}, after_time()); }
  double penalty() const { return std::log(3.0 * static_cast<double>(track_.size())); }
  double scaled_time(double time_s) const { return (time_s - origin_s_) / units_.time_s; }
  double time_s(double scaled) const { return origin_s_ + scaled * units_.time_s; }

 private:
  double after_time() const { return after_.empty() ? 0.0 : after_.front().time; }

  template <class T>
  T with_events(const std::vector<ContactEvent<T>>& own, const T& next_hit) const {
    std::vector<ContactEvent<T>> events;
    for (const auto& event : before_) events.push_back({T(event.time), event.release});
    events.insert(events.end(), own.begin(), own.end());
    for (const auto& event : after_) events.push_back({T(event.time), event.release});
    if (ends_with_hit_) events[before_.size() + own.size()].time = next_hit;
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
  bool begins_with_hit_, ends_with_hit_;
};

/// The best point of a grid around the guess; the likelihood has kinks where an event passes a
/// frame.
double search_grid(const FlightCost& cost, const Flight& guess, double* times) {
  double lowest = std::numeric_limits<double>::infinity();
  const int release_half = cost.release_is_free() ? grid_half : 0;
  for (int i = -release_half; i <= release_half; ++i)
    for (int j = -grid_half; j <= grid_half; ++j) {
      const double at[] = {cost.scaled_time(guess.release_s + i * grid_step_s),
                           cost.scaled_time(guess.landing_s + j * grid_step_s)};
      double value;
      if (cost(at, &value) && value < lowest) lowest = value, times[0] = at[0], times[1] = at[1];
    }
  return lowest;
}

struct FineTimes {
  std::array<double, 2 * scan_half + 1> time_s, likelihood;
};

/// One event's time given the other's: `likelihood` of evenly spaced times.
template <std::size_t count>
void scan(const FlightCost& cost, const double* times, int event, double center_s, double step_s,
          std::array<double, count>& time_s, std::array<double, count>& likelihood) {
  for (std::size_t i = 0; i < count; ++i) {
    time_s[i] = center_s + (static_cast<double>(i) - static_cast<double>(count / 2)) * step_s;
    double at[] = {times[0], times[1]};
    at[event] = cost.scaled_time(time_s[i]);
    if (!cost(at, &likelihood[i])) likelihood[i] = std::numeric_limits<double>::infinity();
  }
  const double least = *std::ranges::min_element(likelihood);
  for (double& l : likelihood) l = std::exp(least - l);
  const double total = std::accumulate(likelihood.begin(), likelihood.end(), 0.0);
  for (double& l : likelihood) l /= total;
}

/// Of each of `result`'s times, how likely an event that takes `duration_s` is under way: it is one
/// at every time within, as far as position and velocity go.
void blur(const FineTimes& fine, double duration_s, LikelyTimes& result) {
  double total = 0.0;
  for (std::size_t k = 0; k < LikelyTimes::count; ++k) {
    result.likelihood[k] = 0.0;
    for (std::size_t i = 0; i < fine.time_s.size(); ++i) {
      const double inside_s = 0.5 * duration_s - std::abs(fine.time_s[i] - result.time_s[k]);
      result.likelihood[k] +=
          fine.likelihood[i] * std::clamp(inside_s / scan_step_s + 0.5, 0.0, 1.0);
    }
    total += result.likelihood[k];
  }
  for (double& l : result.likelihood) l /= total;
}

/// What is known of one event's time given the other's, from its mean and deviation within +-30 ms.
LikelyTimes likely_times(const FlightCost& cost, const double* times, int event,
                         double duration_s) {
  FineTimes fine;
  scan(cost, times, event, cost.time_s(times[event]), scan_step_s, fine.time_s, fine.likelihood);
  double mean = 0.0, variance = duration_s * duration_s / 12.0;
  for (std::size_t i = 0; i < fine.time_s.size(); ++i) mean += fine.likelihood[i] * fine.time_s[i];
  for (std::size_t i = 0; i < fine.time_s.size(); ++i)
    variance += fine.likelihood[i] * std::pow(fine.time_s[i] - mean, 2);
  LikelyTimes result;
  scan(cost, times, event, mean,
       spacing_deviations * std::max(least_deviation_s, std::sqrt(variance)), result.time_s,
       result.likelihood);
  if (duration_s > 0.0) blur(fine, duration_s, result);
  return result;
}

/// The flight with its best times, or nothing if the data speak against it.
std::optional<Flight> refine(const WeightedTrack& track, const MotionUnits& units,
                             const Flight& guess, const std::vector<Flight>& before,
                             const std::vector<Flight>& after, const MotionNoise<double>& noise,
                             const SmoothOptions& options, Doubtful doubtful) {
  const auto window = around(track, guess);
  if (window.points.size() < fewest_points_of_flight) return std::nullopt;
  auto* cost = new FlightCost(window, units, guess, before, after, noise, options);
  const ceres::GradientProblem problem(new ceres::AutoDiffFirstOrderFunction<FlightCost, 2>(cost));
  double times[2] = {0.0, 0.0};
  const double most = doubtful == Doubtful::keep ? std::numeric_limits<double>::infinity()
                                                 : cost->without_flight() - cost->penalty();
  if (!(search_grid(*cost, guess, times) < most)) return std::nullopt;

  ceres::GradientProblemSolver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.line_search_direction_type = ceres::BFGS;
  solver.max_num_iterations = 20;
  ceres::GradientProblemSolver::Summary summary;
  double refined[2] = {times[0], times[1]};
  ceres::Solve(solver, problem, refined, &summary);
  if (summary.IsSolutionUsable()) std::copy_n(refined, 2, times);
  const Flight flight{cost->release_is_free() ? cost->time_s(times[0]) : before.back().landing_s,
                      cost->time_s(times[1])};
  if (around(track, flight).points.size() < fewest_points_of_flight) return std::nullopt;
  return flight;
}

}  // namespace

std::vector<Flight> most_likely_flights(const WeightedTrack& track,
                                        const MotionNoise<double>& noise,
                                        const SmoothOptions& options, Doubtful doubtful) {
  const auto units = MotionUnits::of({track.points});
  std::vector<Flight> found;
  std::vector<Flight> left = track.flights;
  while (!left.empty()) {
    const Flight guess = left.front();
    left.erase(left.begin());
    const bool hit = !left.empty() && left.front().release_s <= guess.landing_s;
    const auto flight = refine(track, units, guess, found, left, noise, options, doubtful);
    if (!flight) continue;
    found.push_back(*flight);
    if (hit) left.front().release_s = flight->landing_s;
  }
  return found;
}

void find_likely_times(WeightedTrack& track, const MotionNoise<double>& noise,
                       const SmoothOptions& options) {
  const auto units = MotionUnits::of({track.points});
  auto& flights = track.flights;
  for (auto flight = flights.begin(); flight != flights.end(); ++flight) {
    const std::vector<Flight> before(flights.begin(), flight), after(flight + 1, flights.end());
    const FlightCost cost(around(track, *flight), units, *flight, before, after, noise, options);
    const double times[] = {cost.scaled_time(flight->release_s),
                            cost.scaled_time(flight->landing_s)};
    flight->likely_landings = likely_times(cost, times, 1, 0.0);
    flight->likely_releases = cost.release_is_free()
                                  ? likely_times(cost, times, 0, options.release_s)
                                  : before.back().likely_landings;
  }
}

}  // namespace touchtrace
