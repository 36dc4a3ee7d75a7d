#include "calib/smooth/scaled_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

/// Throwing and catching are more abrupt than any other motion of a hand for this time.
constexpr double throw_duration_s = 0.2;
/// Standard deviation of an uninformative position, in sigmas of a measurement; more loses digits
/// to rounding.
constexpr double flat_sigmas = 1e3;

double median_or(std::vector<double> values, double otherwise) {
  return values.empty() ? otherwise : median(std::move(values));
}

MotionNoise in_units(const MotionNoise& noise, double length, double time) {
  MotionNoise result = noise;
  result.jerk_density *= std::pow(time, 5) / (length * length);
  result.flight_jerk_density *= std::pow(time, 5) / (length * length);
  result.bandwidth_rad_per_s *= time;
  result.flight_drag_per_s *= time;
  result.flight_velocity_sigma_m_per_s *= time / length;
  result.flight_acceleration_sigma_m_per_s2 *= time * time / length;
  result.landing_velocity_sigma_m_per_s *= time / length;
  result.landing_acceleration_sigma_m_per_s2 *= time * time / length;
  result.wander_sigma_m /= length;
  result.wander_time_s /= time;
  return result;
}

}  // namespace

double ProcessNoiseCurve::elapsed_s(double time_s) const {
  const auto next = std::ranges::upper_bound(pauses, time_s, {}, &Pause::start_s);
  if (next == pauses.begin()) return time_s - start_s;
  const Pause& last = *(next - 1);
  return time_s - start_s - last.before_s - std::min(time_s - last.start_s, last.length_s);
}

std::pair<std::size_t, double> ProcessNoiseCurve::position(double time_s) const {
  const double last = static_cast<double>(log_variance.size() - 1),
               knot = std::clamp(elapsed_s(time_s) / knot_spacing_s, 0.0, last);
  const auto before = std::min(static_cast<std::size_t>(knot), log_variance.size() - 2);
  return {before, knot - static_cast<double>(before)};
}

double ProcessNoiseCurve::at(double time_s) const {
  if (log_variance.empty()) return 0.0;
  const auto [knot, part] = position(time_s);
  return std::lerp(log_variance[knot], log_variance[knot + 1], part);
}

MotionUnits MotionUnits::of(const std::vector<Track>& tracks) {
  std::vector<double> spacings;
  std::array<std::vector<double>, 3> sigmas;
  for (const auto& track : tracks)
    for (std::size_t i = 0; i < track.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        sigmas[axis].push_back(track[i].sigma_m[static_cast<Eigen::Index>(axis)]);
      if (i > 0 && track[i].time_s > track[i - 1].time_s)
        spacings.push_back(track[i].time_s - track[i - 1].time_s);
    }
  std::vector<double> medians;
  for (auto& of_axis : sigmas) medians.push_back(median_or(std::move(of_axis), 1.0));
  return {median_or(std::move(spacings), 1.0), median(std::move(medians))};
}

MotionNoise MotionUnits::scaled(const MotionNoise& noise) const {
  return in_units(noise, length_m, time_s);
}

MotionNoise MotionUnits::unscaled(const MotionNoise& noise) const {
  return in_units(noise, 1.0 / length_m, 1.0 / time_s);
}

ScaledTrack::ScaledTrack(const WeightedTrack& track, const MotionUnits& track_units)
    : units(track_units),
      origin_s(track.points.front().time_s),
      origin_m(track.points.front().position_m),
      events(contact_events(track.flights, origin_s, units.time_s)) {
  double extent = 0.0, previous_s = origin_s;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const auto& point = track.points[i];
    points.push_back({to_scaled_time(point.time_s), (point.position_m - origin_m) / units.length_m,
                      (point.sigma_m / units.length_m).cwiseAbs2() / track.weights[i],
                      track.curve.at(std::midpoint(previous_s, point.time_s))});
    extent = std::max(extent, points.back().position.cwiseAbs().maxCoeff());
    previous_s = point.time_s;
  }
  const double first_sigma = track.points.front().sigma_m.maxCoeff() / units.length_m;
  position_sigma = std::max(flat_sigmas * first_sigma, extent);
}

template <StateModel model>
MotionPrior<model> ScaledTrack::prior(const MotionNoise& noise) const {
  return MotionPrior<model>(noise, events, throw_duration_s / units.time_s);
}

std::vector<ContactEvent> contact_events(const std::vector<Flight>& flights, double origin_s,
                                         double unit_s) {
  std::vector<ContactEvent> events;
  double last = -std::numeric_limits<double>::infinity();
  const auto add = [&](double time_s, bool is_release) {
    last = std::max(last, (time_s - origin_s) / unit_s);
    events.push_back({last, is_release});
  };
  for (const auto& flight : flights) add(flight.release_s, true), add(flight.landing_s, false);
  return events;
}

template MotionPrior<StateModel::contact> ScaledTrack::prior(const MotionNoise&) const;
template MotionPrior<StateModel::with_flights> ScaledTrack::prior(const MotionNoise&) const;

}  // namespace touchtrace
