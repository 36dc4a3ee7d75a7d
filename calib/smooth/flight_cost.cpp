#include "calib/smooth/flight_cost.h"

#include <cmath>
#include <limits>

#include "calib/smooth/likelihood.h"

namespace touchtrace {
namespace {

constexpr double margin_s = 0.35, min_flight_s = 0.04;

}  // namespace

WeightedTrack window_around(const WeightedTrack& track, const Flight& flight) {
  WeightedTrack window;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const double t = track.points[i].time_s;
    if (t < flight.release_s - margin_s || t > flight.landing_s + margin_s) continue;
    window.points.push_back(track.points[i]);
    window.weights.push_back(track.weights[i]);
  }
  return window;
}

FlightCost::FlightCost(const WeightedTrack& window, const MotionUnits& units, const Flight& flight,
                       const std::vector<Flight>& before, const std::vector<Flight>& after,
                       const MotionNoise& noise, const SmoothOptions& options)
    : track_(window, units),
      noise_(units.scaled(noise)),
      gravity_(options.gravity_m_per_s2 / units.acceleration()),
      before_(contact_events(before, track_.origin_s, units.time_s)),
      after_(contact_events(after, track_.origin_s, units.time_s)),
      begins_with_hit_(!before.empty() && flight.release_s <= before.back().landing_s),
      ends_with_hit_(!after.empty() && after.front().release_s <= flight.landing_s) {}

double FlightCost::operator()(const double* times) const {
  const double release = begins_with_hit_ ? before_.back().time : times[0], landing = times[1];
  const auto next = static_cast<std::size_t>(ends_with_hit_);
  if (landing < release + min_flight_s / track_.units.time_s ||
      (!before_.empty() && release < before_.back().time) ||
      (next < after_.size() && after_[next].time < landing))
    return std::numeric_limits<double>::infinity();
  return with_events({{release, true}, {landing, false}}, landing);
}

double FlightCost::without_flight() const {
  return with_events({}, after_.empty() ? 0.0 : after_.front().time);
}

double FlightCost::penalty() const {
  return 0.5 * std::log(3.0 * static_cast<double>(track_.points.size()));
}

double FlightCost::with_events(const std::vector<ContactEvent>& own, double next_hit) const {
  ScaledTrack track = track_;
  track.events = before_;
  track.events.insert(track.events.end(), own.begin(), own.end());
  track.events.insert(track.events.end(), after_.begin(), after_.end());
  if (ends_with_hit_) track.events[before_.size() + own.size()].time = next_hit;
  return negative_log_likelihood(track, noise_, gravity_);
}

}  // namespace touchtrace
