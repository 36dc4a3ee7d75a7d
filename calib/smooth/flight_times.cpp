#include "calib/smooth/flight_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "calib/smooth/flight_cost.h"
#include "calib/smooth/join_flights.h"

namespace touchtrace {
namespace {

constexpr double grid_step_s = 0.02, min_step_s = 2e-4;
constexpr int grid_half = 3, max_moves = 5;
constexpr std::size_t min_points_per_flight = 3;  // in a flight and its margins
/// Steps of scans over the times of an event. The first one spans +-150 ms, in which a release
/// often has several likely times, as a throwing hand accelerates a body nearly like a flight does.
/// Finer ones follow while the likely times are within two steps.
constexpr double scan_steps_s[] = {5e-3, 1e-3, 2e-4};
constexpr int scan_half = 30;
/// Grid spacing of EventTimeDistribution in standard deviations. Of a normal distribution, 0.07 %
/// are beyond the grid, and the bins add 2 % to the standard deviation.
constexpr double spacing_sigmas = 0.75;

/// Costs of the points of square grids around release and landing times. Each is computed once.
class GridSearch {
 public:
  GridSearch(const FlightCost& cost, const double* times)
      : cost_(cost), origin_{times[0], times[1]} {}

  /// Moves to the best point within `half` steps, if it is below the lowest so far, and returns
  /// whether it is.
  bool move(double step, int half) {
    if (step != step_) {
      origin_ = times(), at_ = {0, 0}, step_ = step;
      known_.clear();
      if (std::isfinite(lowest_)) known_[at_] = lowest_;
    }
    const auto [release, landing] = at_;
    const double before = lowest_;
    const int release_half = cost_.is_release_free() ? half : 0;
    for (int i = release - release_half; i <= release + release_half; ++i)
      for (int j = landing - half; j <= landing + half; ++j)
        if (const auto [value, is_new] = known_.try_emplace({i, j}); is_new) {
          value->second = cost_(point({i, j}).data());
          if (value->second < lowest_) lowest_ = value->second, at_ = {i, j};
        }
    return lowest_ < before;
  }

  std::array<double, 2> times() const { return point(at_); }
  double lowest() const { return lowest_; }

 private:
  using Steps = std::array<int, 2>;

  std::array<double, 2> point(const Steps& at) const {
    return {origin_[0] + at[0] * step_, origin_[1] + at[1] * step_};
  }

  const FlightCost& cost_;
  std::array<double, 2> origin_;
  Steps at_{0, 0};
  double step_ = 0.0, lowest_ = std::numeric_limits<double>::infinity();
  std::map<Steps, double> known_;
};

/// Sets `times` to the best ones around a guess and returns their cost, which is infinite if there
/// are none. Uses grids, which move until their centre is best and then shrink: the likelihood has
/// kinks where an event passes a frame.
double search(const FlightCost& cost, const Flight& guess, double unit_s, double* times) {
  times[0] = cost.scaled_time(guess.release_s), times[1] = cost.scaled_time(guess.landing_s);
  GridSearch grid(cost, times);
  for (int moves = 0; moves < max_moves && grid.move(grid_step_s / unit_s, grid_half);) ++moves;
  for (double step_s = grid_step_s / 2.0; step_s > min_step_s; step_s /= 2.0)
    grid.move(step_s / unit_s, 1);
  std::ranges::copy(grid.times(), times);
  return grid.lowest();
}

bool begins_before(const Track& points, const Flight& flight) {
  return flight.release_s <= points.front().time_s;
}

bool ends_after(const Track& points, const Flight& flight) {
  return flight.landing_s > points.back().time_s;
}

/// Moves release and landing to before and after the track's `points` if that explains the points
/// of `window`, which cost `lowest`, as well as `times` do, by the Bayesian information criterion:
/// an event outside has no time to estimate. The window must reach that end of the track.
void move_outside(const FlightCost& cost, const Track& window, const Track& points, double lowest,
                  double* times) {
  const bool reaches[] = {window.front().time_s <= points.front().time_s,
                          window.back().time_s >= points.back().time_s};
  const double outside[] = {cost.scaled_time(points.front().time_s),
                            cost.scaled_time(points.back().time_s) + 1.0};
  for (const int event : {0, 1}) {
    if (!reaches[event] || !(event == 0 ? cost.is_release_free() : cost.is_last())) continue;
    double at[] = {times[0], times[1]};
    at[event] = outside[event];
    if (cost(at) < lowest + cost.penalty()) times[event] = outside[event];
  }
}

/// Distribution of an event's time on even steps around its likely times.
using FineDistribution = TimeDistribution<2 * scan_half + 1>;

/// Distribution of one event's time given the other's, around `center_s`. `event`: 0 release, 1
/// landing.
FineDistribution scan(const FlightCost& cost, const double* times, int event, double center_s,
                      double step_s) {
  FineDistribution result;
  auto& [time_s, probability] = result;
  for (std::size_t i = 0; i < result.count; ++i) {
    time_s[i] = center_s + (static_cast<double>(i) - scan_half) * step_s;
    double at[] = {times[0], times[1]};
    at[event] = cost.scaled_time(time_s[i]);
    probability[i] = cost(at);
  }
  const double lowest = *std::ranges::min_element(probability);
  for (double& p : probability) p = std::exp(lowest - p);
  const double total = std::accumulate(probability.begin(), probability.end(), 0.0);
  for (double& p : probability) p /= total;
  return result;
}

FineDistribution fine_distribution(const FlightCost& cost, const double* times, int event) {
  FineDistribution fine;
  double center_s = cost.time_s(times[event]);
  for (const double step_s : scan_steps_s) {
    fine = scan(cost, times, event, center_s, step_s);
    if (fine.sigma_s() > 2.0 * step_s) break;
    center_s = fine.mean_s();
  }
  return fine;
}

/// Distribution of one event's time given the other's.
EventTimeDistribution event_distribution(const FlightCost& cost, const double* times, int event) {
  const auto fine = fine_distribution(cost, times, event);
  const double width_s = fine.time_s[1] - fine.time_s[0],
               spacing_s = spacing_sigmas * std::hypot(fine.sigma_s(), width_s / std::sqrt(12.0));
  EventTimeDistribution result;
  double below = 0.0;
  for (std::size_t k = 0; k < result.count; ++k) {
    const double steps = static_cast<double>(k) - static_cast<double>(result.count / 2);
    result.time_s[k] = fine.mean_s() + steps * spacing_s;
    double below_end = k + 1 < result.count ? 0.0 : 1.0;  // the first and last bins have the tails
    for (std::size_t i = 0; i < fine.count && k + 1 < result.count; ++i) {
      const double end_s = result.time_s[k] + 0.5 * spacing_s;
      below_end +=
          fine.probability[i] * std::clamp((end_s - fine.time_s[i]) / width_s + 0.5, 0.0, 1.0);
    }
    result.probability[k] = below_end - std::exchange(below, below_end);
  }
  return result;
}

/// Distribution of an event outside the track.
EventTimeDistribution fixed(double time_s) {
  EventTimeDistribution result;
  result.time_s.fill(time_s);
  result.probability[result.count / 2] = 1.0;
  return result;
}

/// Returns the flight with its maximum-likelihood times, or nullopt if there are too few points or
/// it is implausible.
std::optional<Flight> refine(const WeightedTrack& track, const MotionUnits& units,
                             const Flight& guess, const std::vector<Flight>& before,
                             const std::vector<Flight>& after, const MotionNoise& noise,
                             const SmoothOptions& options, DoubtfulFlights doubtful) {
  const auto window = window_around(track, guess);
  if (window.points.size() < min_points_per_flight) return std::nullopt;
  const FlightCost cost(window, units, guess, before, after, noise, options);
  double times[2];
  const double max_cost =
      cost.without_flight() + (doubtful == DoubtfulFlights::keep ? 2.0 : -2.0) * cost.penalty();
  const double lowest = search(cost, guess, units.time_s, times);
  if (!(lowest < max_cost)) return std::nullopt;
  move_outside(cost, window.points, track.points, lowest, times);
  const Flight flight{cost.is_release_free() ? cost.time_s(times[0]) : before.back().landing_s,
                      cost.time_s(times[1])};
  if (window_around(track, flight).points.size() < min_points_per_flight) return std::nullopt;
  return flight;
}

}  // namespace

std::vector<Flight> estimate_flights(const WeightedTrack& track, const MotionNoise& noise,
                                     const SmoothOptions& options, DoubtfulFlights doubtful) {
  const auto units = MotionUnits::of({track.points});
  std::vector<Flight> found;
  std::vector<Flight> remaining = track.flights;
  while (!remaining.empty()) {
    const Flight guess = remaining.front();
    remaining.erase(remaining.begin());
    const bool ends_with_hit = !remaining.empty() && remaining.front().release_s <= guess.landing_s;
    const auto flight = refine(track, units, guess, found, remaining, noise, options, doubtful);
    if (!flight) continue;
    found.push_back(*flight);
    if (ends_with_hit) remaining.front().release_s = flight->landing_s;
  }
  return join_flights(track, std::move(found), noise, options);
}

void estimate_event_distributions(WeightedTrack& track, const MotionNoise& noise,
                                  const SmoothOptions& options) {
  const auto units = MotionUnits::of({track.points});
  auto& flights = track.flights;
  for (auto flight = flights.begin(); flight != flights.end(); ++flight) {
    const std::vector<Flight> before(flights.begin(), flight), after(flight + 1, flights.end());
    const FlightCost cost(window_around(track, *flight), units, *flight, before, after, noise,
                          options);
    const double times[] = {cost.scaled_time(flight->release_s),
                            cost.scaled_time(flight->landing_s)};
    flight->landing_distribution = ends_after(track.points, *flight)
                                       ? fixed(flight->landing_s)
                                       : event_distribution(cost, times, 1);
    flight->release_distribution = !cost.is_release_free() ? before.back().landing_distribution
                                   : begins_before(track.points, *flight)
                                       ? fixed(flight->release_s)
                                       : event_distribution(cost, times, 0);
  }
  for (auto& flight : flights) {  // only now: each event is given the others' likeliest times
    flight.release_s = flight.release_distribution.mean_s();
    flight.landing_s = flight.landing_distribution.mean_s();
  }
}

}  // namespace touchtrace
