#include "pipeline/label/flights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr double fewest_away_m = 0.05;    // from the grip's distance: the object has left the hand
constexpr double longest_bridge_s = 0.2;  // of frames that do not look like flying
constexpr double longest_out_of_sight_s = 0.5, longest_toss_s = 1.0;
constexpr double like_gravity_m_per_s2 = 3.0;  // drag, tilt and a second difference's noise
constexpr double least_fall_m = 0.03;          // to a hit, and least rise after it
constexpr double least_deviations = 5.0;       // of what is no error

/// Distance of hand and object in every frame; NaN where one was not seen.
std::vector<double> distances(const ClipTrack& track) {
  std::vector<double> result;
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    result.push_back(track.hand[i].found && track.object[i].found
                         ? (track.object[i].position_m - track.hand[i].position_m).norm()
                         : std::numeric_limits<double>::quiet_NaN());
  return result;
}

/// [frames] Whether the object is further from the hand than where the grip has it.
std::vector<bool> is_away(const ClipTrack& track) {
  const auto distance = distances(track);
  std::vector<double> seen;
  std::ranges::copy_if(distance, std::back_inserter(seen),
                       [](double d) { return std::isfinite(d); });
  const double away = seen.empty() ? 0.0 : median(std::move(seen)) + fewest_away_m;
  std::vector<bool> result;
  for (double d : distance) result.push_back(d > away);
  return result;
}

/// Second difference of the object's place over a frame and its neighbours; nothing where one was
/// not seen.
std::optional<Eigen::Vector3d> acceleration_at(const ClipTrack& track, std::size_t i) {
  const auto &a = track.object[i - 1], &b = track.object[i], &c = track.object[i + 1];
  if (!a.found || !b.found || !c.found) return std::nullopt;
  const double before_s = track.time_s[i] - track.time_s[i - 1],
               after_s = track.time_s[i + 1] - track.time_s[i];
  return 2.0 / (before_s + after_s) *
         ((c.position_m - b.position_m) / after_s - (b.position_m - a.position_m) / before_s);
}

bool is_like_gravity(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& gravity) {
  return (acceleration - gravity).norm() < like_gravity_m_per_s2;
}

/// [frames] Whether the object falls freely, in two frames in a row at least: in one a hand may
/// happen to move it so. Where it was lost a frame before or after, being away from the hand will
/// do.
std::vector<bool> falls(const ClipTrack& track, const Eigen::Vector3d& gravity) {
  const std::size_t count = track.time_s.size();
  const auto away = is_away(track);
  std::vector<bool> now(count), result(count);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const auto acceleration = acceleration_at(track, i);
    now[i] = acceleration && is_like_gravity(*acceleration, gravity);
    if (now[i] && now[i - 1]) result[i - 1] = result[i] = true;
    if (!acceleration && away[i]) result[i] = true;
  }
  return result;
}

/// Whether nothing speaks against a flight from one frame to a later one: little time, or nothing
/// is known of the object's acceleration in between.
bool is_bridged(const ClipTrack& track, std::size_t from, std::size_t to) {
  const double gap_s = track.time_s[to] - track.time_s[from];
  if (gap_s < longest_bridge_s) return true;
  bool known = false;
  for (std::size_t i = from + 1; i < to; ++i) known |= acceleration_at(track, i).has_value();
  return gap_s < longest_out_of_sight_s && !known;
}

/// From the first to the last frame of those that are `in`, over short gaps, and so much beyond:
/// what flies began to before it shows.
std::vector<Flight> stretches(const ClipTrack& track, const std::vector<bool>& in, double before_s,
                              double after_s) {
  std::vector<Flight> result;
  std::size_t last = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (!in[i]) continue;
    if (!result.empty() && is_bridged(track, last, i))
      result.back().landing_s = track.time_s[i];
    else
      result.push_back({track.time_s[i], track.time_s[i]});
    last = i;
  }
  std::erase_if(result, [](const Flight& f) { return !(f.landing_s > f.release_s); });
  for (auto& flight : result) flight.release_s -= before_s, flight.landing_s += after_s;
  return result;
}

bool overlap(const Flight& a, const Flight& b) {
  return a.release_s < b.landing_s && b.release_s < a.landing_s;
}

/// Joins it with the falls that it holds parts of, but where it is too long for a flight: then what
/// fell lies somewhere.
void add_away(Flight away, std::vector<Flight>& flights) {
  const bool flies = away.landing_s - away.release_s < longest_toss_s;
  const auto overlaps = [&](const Flight& f) { return overlap(f, away); };
  if (!flies && std::ranges::any_of(flights, overlaps)) return;
  std::erase_if(flights, [&](const Flight& f) {
    if (!overlaps(f)) return false;
    away = {std::min(f.release_s, away.release_s), std::max(f.landing_s, away.landing_s)};
    return true;
  });
  flights.push_back(away);
}

/// Of the places that were seen, against gravity.
struct Height {
  double time_s, height_m, variance_m2;
};

std::vector<Height> heights(const ClipTrack& track, const Eigen::Vector3d& up) {
  std::vector<Height> result;
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    if (track.object[i].found)
      result.push_back({track.time_s[i], up.dot(track.object[i].position_m),
                        up.cwiseAbs2().dot(track.object[i].sigma_m.cwiseAbs2())});
  return result;
}

/// Whether there was a hit between `edge` and two places of one flight: it lies above where that
/// flight leads to or comes from.
bool is_beyond_hit(const Height& edge, const Height& near, const Height& far, double gravity) {
  const double on_s = edge.time_s - near.time_s, part = on_s / (near.time_s - far.time_s);
  const double falling_m = near.height_m + part * (near.height_m - far.height_m) -
                           0.5 * gravity * on_s * (edge.time_s - far.time_s);
  const double variance_m2 = edge.variance_m2 + std::pow(1.0 + part, 2) * near.variance_m2 +
                             std::pow(part, 2) * far.variance_m2;
  return edge.height_m - falling_m >
         std::max(least_fall_m, least_deviations * std::sqrt(variance_m2));
}

void add_hit(std::vector<Flight>& flights, std::vector<Flight>::iterator flight, double hit_s) {
  const double release_s = std::exchange(flight->release_s, hit_s);
  flights.insert(flight, {release_s, hit_s});
}

/// Hits next to the first and last place have no lowest place between two flights.
void add_hits_at_ends(const std::vector<Height>& seen, double gravity,
                      std::vector<Flight>& flights) {
  const std::size_t n = seen.size();
  if (n < 3) return;
  if (seen[2].time_s < flights.front().landing_s &&
      is_beyond_hit(seen[0], seen[1], seen[2], gravity))
    add_hit(flights, flights.begin(), std::midpoint(seen[0].time_s, seen[1].time_s));
  if (seen[n - 3].time_s > flights.back().release_s &&
      is_beyond_hit(seen[n - 1], seen[n - 2], seen[n - 3], gravity))
    add_hit(flights, flights.end() - 1, std::midpoint(seen[n - 1].time_s, seen[n - 2].time_s));
}

}  // namespace

std::vector<Flight> guess_flights(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2) {
  auto flights = stretches(track, falls(track, gravity_m_per_s2), 0.05, 0.05);
  for (const Flight& away : stretches(track, is_away(track), 0.05, 0.03)) add_away(away, flights);
  std::ranges::sort(flights, {}, &Flight::release_s);
  return flights;
}

std::vector<Flight> guess_bounces(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2) {
  const auto seen = heights(track, -gravity_m_per_s2.normalized());
  if (seen.size() < 2) return {};
  std::vector<Flight> flights;
  double highest_m = seen.front().height_m, begin_s = seen.front().time_s - longest_bridge_s;
  Height lowest = seen.front();
  for (const Height& now : seen) {
    if (now.height_m < lowest.height_m) lowest = now;
    const bool has_fallen = highest_m - lowest.height_m > least_fall_m,
               rises = now.height_m - lowest.height_m > least_fall_m;
    if (has_fallen && rises) {
      flights.push_back({begin_s, lowest.time_s});
      begin_s = lowest.time_s;
      highest_m = now.height_m;
      lowest = now;
    }
    if (now.height_m > highest_m) highest_m = now.height_m, lowest = now;
  }
  flights.push_back({begin_s, seen.back().time_s + longest_bridge_s});
  add_hits_at_ends(seen, gravity_m_per_s2.norm(), flights);
  return flights;
}

double falling_part(const std::vector<ClipTrack>& tracks, const Eigen::Vector3d& gravity_m_per_s2) {
  double frames = 0.0, falling = 0.0;
  for (const auto& track : tracks)
    for (std::size_t i = 2; i < track.time_s.size(); ++i) {
      const auto acceleration = acceleration_at(track, i - 1);
      if (!acceleration) continue;
      frames += 1.0;
      falling += is_like_gravity(*acceleration, gravity_m_per_s2);
    }
  return frames > 0.0 ? falling / frames : 0.0;
}

}  // namespace touchtrace::label
