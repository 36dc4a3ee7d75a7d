#include "pipeline/label/states/flights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/base/statistics.h"

namespace touchtrace::label {
namespace {

constexpr double min_away_m =
    0.05;  // beyond the grip's distance; farther: the object left the hand
constexpr double min_parting_m = 0.02;   // change of the distance to the hand in a flight
constexpr double max_doubtful_s = 0.25;  // of a flight at the hand's distance
constexpr double max_bridge_s = 0.2;     // of frames inside a flight that do not look like one
constexpr double max_occlusion_s = 0.5, max_toss_s = 1.0;
constexpr double gravity_tolerance_m_per_s2 = 3.0;  // drag, tilt, noise of a second difference
constexpr double min_fall_m = 0.03;                 // before a hit, and rise after it
constexpr double min_sigmas = 5.0;                  // of a position above the extrapolated fall

/// [frames] Distance of hand and object; NaN if either was not found.
std::vector<double> distances(const ClipTrack& track) {
  std::vector<double> result;
  for (std::size_t i = 0; i < track.time_s.size(); ++i)
    result.push_back(track.hand[i].found && track.object[i].found
                         ? (track.object[i].position_m - track.hand[i].position_m).norm()
                         : std::numeric_limits<double>::quiet_NaN());
  return result;
}

/// [frames] Whether the object is farther from the hand than in the grip (median distance).
std::vector<bool> is_away(const ClipTrack& track) {
  const auto distance = distances(track);
  std::vector<double> known;
  std::ranges::copy_if(distance, std::back_inserter(known),
                       [](double d) { return std::isfinite(d); });
  const double away = known.empty() ? 0.0 : median(std::move(known)) + min_away_m;
  std::vector<bool> result;
  for (double d : distance) result.push_back(d > away);
  return result;
}

/// Second difference of the object's position over a frame and its neighbours; nullopt if it was
/// not found in all three.
std::optional<Eigen::Vector3d> acceleration_at(const ClipTrack& track, std::size_t i) {
  const auto &a = track.object[i - 1], &b = track.object[i], &c = track.object[i + 1];
  if (!a.found || !b.found || !c.found) return std::nullopt;
  const double before_s = track.time_s[i] - track.time_s[i - 1],
               after_s = track.time_s[i + 1] - track.time_s[i];
  return 2.0 / (before_s + after_s) *
         ((c.position_m - b.position_m) / after_s - (b.position_m - a.position_m) / before_s);
}

bool is_like_gravity(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& gravity) {
  return (acceleration - gravity).norm() < gravity_tolerance_m_per_s2;
}

/// [frames] Whether the object is in free fall, in at least two consecutive frames: in a single one
/// a hand may accelerate it like gravity. Next to a frame without the object, distance from the
/// hand decides.
std::vector<bool> is_falling(const ClipTrack& track, const Eigen::Vector3d& gravity) {
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

/// Whether two frames may belong to one flight: the gap is short, or longer without any known
/// acceleration of the object in it.
bool is_bridged(const ClipTrack& track, std::size_t from, std::size_t to) {
  const double gap_s = track.time_s[to] - track.time_s[from];
  if (gap_s < max_bridge_s) return true;
  bool is_known = false;
  for (std::size_t i = from + 1; i < to; ++i) is_known |= acceleration_at(track, i).has_value();
  return gap_s < max_occlusion_s && !is_known;
}

/// Stretches of frames for which `in` is true, joined over short gaps and extended by `before_s`
/// and `after_s`: a flight begins before it is detected.
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

/// Whether a stretch is short and shows hand and object at distances that vary by less than an
/// object's that leaves the hand. Noise of positions in a hand looks like a short fall.
bool stays_in_hand(const ClipTrack& track, const Flight& flight) {
  if (flight.landing_s - flight.release_s > max_doubtful_s) return false;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  const auto distance = distances(track);
  for (std::size_t i = 0; i < track.time_s.size(); ++i) {
    if (track.time_s[i] < flight.release_s || track.time_s[i] > flight.landing_s) continue;
    if (std::isnan(distance[i])) return false;
    least = std::min(least, distance[i]), most = std::max(most, distance[i]);
  }
  return most - least < min_parting_m;
}

bool overlap(const Flight& a, const Flight& b) {
  return a.release_s < b.landing_s && b.release_s < a.landing_s;
}

/// Whether the object's acceleration is known in at least half of a stretch's frames.
bool is_mostly_seen(const ClipTrack& track, const Flight& stretch) {
  std::size_t frames = 0, known = 0;
  for (std::size_t i = 1; i + 1 < track.time_s.size(); ++i) {
    if (track.time_s[i] < stretch.release_s || track.time_s[i] > stretch.landing_s) continue;
    ++frames;
    known += acceleration_at(track, i).has_value();
  }
  return 2 * known >= frames;
}

/// Adds a stretch away from the hand, merged with the falls that it overlaps. A stretch too long
/// for a toss is dropped if it overlaps a fall, or if the object is seen not to fall: it lies
/// somewhere.
void add_away(const ClipTrack& track, Flight away, std::vector<Flight>& flights) {
  const bool flies = away.landing_s - away.release_s < max_toss_s;
  const auto overlaps = [&](const Flight& f) { return overlap(f, away); };
  if (!flies && (is_mostly_seen(track, away) || std::ranges::any_of(flights, overlaps))) return;
  std::erase_if(flights, [&](const Flight& f) {
    if (!overlaps(f)) return false;
    away = {std::min(f.release_s, away.release_s), std::max(f.landing_s, away.landing_s)};
    return true;
  });
  flights.push_back(away);
}

/// Height of a found object, against gravity.
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

/// Whether a hit separates `edge` from `near` and `far`, two positions of one flight: `edge` is
/// above that flight's extrapolation.
bool is_beyond_hit(const Height& edge, const Height& near, const Height& far, double gravity) {
  const double step_s = edge.time_s - near.time_s, part = step_s / (near.time_s - far.time_s);
  const double falling_m = near.height_m + part * (near.height_m - far.height_m) -
                           0.5 * gravity * step_s * (edge.time_s - far.time_s);
  const double variance_m2 = edge.variance_m2 + std::pow(1.0 + part, 2) * near.variance_m2 +
                             std::pow(part, 2) * far.variance_m2;
  return edge.height_m - falling_m > std::max(min_fall_m, min_sigmas * std::sqrt(variance_m2));
}

void add_hit(std::vector<Flight>& flights, std::vector<Flight>::iterator flight, double hit_s) {
  const double release_s = std::exchange(flight->release_s, hit_s);
  flights.insert(flight, {release_s, hit_s});
}

/// Hits next to the first and last position have no lowest point between two flights.
void add_hits_at_ends(const std::vector<Height>& heights, double gravity,
                      std::vector<Flight>& flights) {
  const std::size_t n = heights.size();
  if (n < 3) return;
  if (heights[2].time_s < flights.front().landing_s &&
      is_beyond_hit(heights[0], heights[1], heights[2], gravity))
    add_hit(flights, flights.begin(), std::midpoint(heights[0].time_s, heights[1].time_s));
  if (heights[n - 3].time_s > flights.back().release_s &&
      is_beyond_hit(heights[n - 1], heights[n - 2], heights[n - 3], gravity))
    add_hit(flights, flights.end() - 1,
            std::midpoint(heights[n - 1].time_s, heights[n - 2].time_s));
}

}  // namespace

std::vector<Flight> guess_flights(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2) {
  auto flights = stretches(track, is_falling(track, gravity_m_per_s2), 0.05, 0.05);
  std::erase_if(flights, [&](const Flight& flight) { return stays_in_hand(track, flight); });
  for (const Flight& away : stretches(track, is_away(track), 0.05, 0.03))
    add_away(track, away, flights);
  std::ranges::sort(flights, {}, &Flight::release_s);
  return flights;
}

std::vector<Flight> guess_bounces(const ClipTrack& track, const Eigen::Vector3d& gravity_m_per_s2) {
  const auto all = heights(track, -gravity_m_per_s2.normalized());
  if (all.size() < 2) return {};
  std::vector<Flight> flights;
  double highest_m = all.front().height_m, begin_s = all.front().time_s - max_bridge_s;
  Height lowest = all.front();
  for (const Height& now : all) {
    if (now.height_m < lowest.height_m) lowest = now;
    const bool has_fallen = highest_m - lowest.height_m > min_fall_m,
               rises = now.height_m - lowest.height_m > min_fall_m;
    if (has_fallen && rises) {
      flights.push_back({begin_s, lowest.time_s});
      begin_s = lowest.time_s;
      highest_m = now.height_m;
      lowest = now;
    }
    if (now.height_m > highest_m) highest_m = now.height_m, lowest = now;
  }
  flights.push_back({begin_s, all.back().time_s + max_bridge_s});
  add_hits_at_ends(all, gravity_m_per_s2.norm(), flights);
  return flights;
}

double free_fall_fraction(const std::vector<ClipTrack>& tracks,
                          const Eigen::Vector3d& gravity_m_per_s2) {
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
