#include "calib/smooth/join_flights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/smooth/flight_cost.h"

namespace touchtrace {
namespace {

/// Longest contact that may be a hit. A juggler holds a ball for 0.2 s and more.
constexpr double max_contact_s = 0.15;
/// A hit is searched from this before the contact to this after it, in steps that shrink.
constexpr double margin_s = 0.05, first_step_s = 2.5e-3, last_step_s = 2e-4;

/// Two neighbouring flights and what may be between them: contact, a hit or nothing.
class FlightPair {
 public:
  FlightPair(const WeightedTrack& track, const std::vector<Flight>& before, const Flight& first,
             const Flight& second, const std::vector<Flight>& after, const MotionNoise& noise,
             const SmoothOptions& options)
      : window_(window_around(track, {first.release_s, second.landing_s})),
        units_(MotionUnits::of({track.points})),
        before_(before),
        first_(first),
        second_(second),
        after_(after),
        noise_(noise),
        options_(options) {}

  /// One flight, or two.
  std::vector<Flight> likeliest() const {
    const Flight whole{first_.release_s, second_.landing_s};
    const double nothing = cost_at(cost_of(whole, {}), whole);
    Flight first = first_, second = second_;
    const double hit = move_to_hit(first, second);
    const auto contact_cost = cost_of(first_, {second_});
    const double penalty = contact_cost.penalty();
    const bool is_hit = second_.release_s <= first_.landing_s;
    const double contact =
        is_hit ? std::numeric_limits<double>::infinity() : cost_at(contact_cost, first_) + penalty;
    if (nothing < std::min(hit, contact) + penalty) return {whole};
    return hit < contact ? std::vector{first, second} : std::vector{first_, second_};
  }

 private:
  FlightCost cost_of(const Flight& flight, std::vector<Flight> next) const {
    next.insert(next.end(), after_.begin(), after_.end());
    return {window_, units_, flight, before_, next, noise_, options_};
  }

  static double cost_at(const FlightCost& cost, const Flight& flight) {
    const double times[] = {cost.scaled_time(flight.release_s), cost.scaled_time(flight.landing_s)};
    return cost(times);
  }

  /// Moves `first`'s landing and `second`'s release to the likeliest hit. Returns its cost.
  double move_to_hit(Flight& first, Flight& second) const {
    const double from_s = first.landing_s - margin_s, to_s = second.release_s + margin_s;
    second.release_s = first.landing_s;
    const auto cost = cost_of(first, {second});
    double lowest = std::numeric_limits<double>::infinity(), best_s = first.landing_s;
    const auto scan = [&](double center_s, double step_s, int half) {
      for (int i = -half; i <= half; ++i) {
        const double hit_s = center_s + i * step_s, value = cost_at(cost, {first.release_s, hit_s});
        if (value < lowest) lowest = value, best_s = hit_s;
      }
    };
    scan(0.5 * (from_s + to_s), first_step_s,
         static_cast<int>(std::ceil(0.5 * (to_s - from_s) / first_step_s)));
    for (double step_s = first_step_s / 2.0; step_s > last_step_s; step_s /= 2.0)
      scan(best_s, step_s, 1);
    first.landing_s = second.release_s = best_s;
    return lowest;
  }

  WeightedTrack window_;
  MotionUnits units_;
  const std::vector<Flight>& before_;
  const Flight &first_, &second_;
  const std::vector<Flight>& after_;
  const MotionNoise& noise_;
  const SmoothOptions& options_;
};

}  // namespace

std::vector<Flight> join_flights(const WeightedTrack& track, std::vector<Flight> flights,
                                 const MotionNoise& noise, const SmoothOptions& options) {
  std::vector<Flight> joined;
  while (!flights.empty()) {
    const Flight second = flights.front();
    flights.erase(flights.begin());
    if (joined.empty() || second.release_s - joined.back().landing_s > max_contact_s) {
      joined.push_back(second);
      continue;
    }
    const Flight first = joined.back();
    joined.pop_back();
    const FlightPair pair(track, joined, first, second, flights, noise, options);
    for (const auto& flight : pair.likeliest()) joined.push_back(flight);
  }
  return joined;
}

}  // namespace touchtrace
