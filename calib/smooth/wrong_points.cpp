#include "calib/smooth/wrong_points.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "calib/smooth/noise_estimate.h"
#include "calib/smooth/robust_smoother.h"
#include "engine/base/parallel.h"

namespace touchtrace {
namespace {

/// Time around suspected points that a decision looks at, and points that it needs there.
constexpr double margin_s = 1.0;
constexpr std::size_t min_points_around = 6;

/// Measurements of a lower weight may belong to a strike, several within `max_gap_s` to one.
constexpr double max_weight = 0.5, max_gap_s = 0.3;
/// Largest cost of a strike: what wrong measurements cost, in nats. If these occur once in 10^4
/// frames and are spread over 1 m, with a sigma of 2 mm, it is log 10^4 + 3 log(1 m / 2 mm sqrt(2
/// pi)). Per measurement, half of the strikes of timpani mallets at 20 Hz cost less than 20, 95 %
/// less than 34; 95 % of single errors of 10 cm, added to them, more than 29 at a sigma of 2 mm and
/// more than 19 at 5 mm.
constexpr double max_strike_cost = 25.0;

/// Process noise curve of a jump, and the longest run of wrong measurements.
constexpr double min_jump = 2.0, max_run_s = 0.2;
/// Least advantage of a common error over a motion. At a sigma of 2 mm, 95 % of the runs of three
/// and six errors of 10 cm that were added to mallets (60 Hz) and arms (20 and 60 Hz) have more
/// than 70; of their true jumps 95 % have less than 21.
constexpr double min_run_advantage = 40.0;

/// Points `first` to `last` of a track.
struct PointRange {
  std::size_t first, last;

  std::size_t size() const { return last - first + 1; }
  bool contains(std::size_t i) const { return first <= i && i <= last; }
};

/// Mean position and time of some points.
TrackPoint mean_of(const Track& points, const PointRange& range) {
  TrackPoint mean{0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = range.first; i <= range.last; ++i)
    mean.time_s += points[i].time_s, mean.position_m += points[i].position_m;
  const auto count = static_cast<double>(range.size());
  return {mean.time_s / count, mean.position_m / count, {}};
}

/// The part of a track around suspected points, and the same without these.
struct Part {
  WeightedTrack with, without;
  PointRange range;  ///< first to last suspected point of `with`
};

/// `is_suspected(i)`: whether point i of `range` is suspected. nullopt where too little is around
/// them: at an end of the track nothing shows what the motion was.
std::optional<Part> part_around(const WeightedTrack& track, const PointRange& range,
                                const std::function<bool(std::size_t)>& is_suspected) {
  const double start_s = track.points[range.first].time_s - margin_s,
               end_s = track.points[range.last].time_s + margin_s;
  const auto start = std::ranges::lower_bound(track.points, start_s, {}, &TrackPoint::time_s);
  Part part{};
  for (auto i = static_cast<std::size_t>(start - track.points.begin()); i < track.points.size();
       ++i) {
    const auto& point = track.points[i];
    if (point.time_s > end_s) break;
    if (i == range.first) part.range.first = part.with.points.size();
    if (i == range.last) part.range.last = part.with.points.size();
    const bool suspected = range.contains(i) && is_suspected(i);
    part.with.points.push_back(point);
    part.with.weights.push_back(suspected ? 1.0 : track.weights[i]);
    if (suspected) continue;
    part.without.points.push_back(point);
    part.without.weights.push_back(track.weights[i]);
  }
  if (part.without.points.size() < min_points_around || part.range.first == 0 ||
      part.range.last + 1 == part.with.points.size())
    return std::nullopt;
  for (const auto& flight : track.flights)
    if (flight.release_s < end_s && flight.landing_s > start_s) part.with.flights.push_back(flight);
  part.without.flights = part.with.flights;
  return part;
}

std::vector<PointRange> suspected_strikes(const WeightedTrack& track) {
  std::vector<PointRange> ranges;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    if (track.weights[i] > max_weight || track.judgements[i] != Judgement::none) continue;
    const double time_s = track.points[i].time_s;
    if (!ranges.empty() && time_s - track.points[ranges.back().last].time_s < max_gap_s)
      ranges.back().last = i;
    else
      ranges.push_back({i, i});
  }
  return ranges;
}

bool is_strike(const WeightedTrack& track, const PointRange& range, const MotionNoise& noise,
               const SmoothOptions& options) {
  auto part = part_around(track, range, [&](std::size_t i) {
    return track.weights[i] <= max_weight && track.judgements[i] == Judgement::none;
  });
  return part && estimate_curve(part->with, noise, options) -
                         estimate_curve(part->without, noise, options) <
                     max_strike_cost;
}

/// The points within `jump` whose mean is farthest from the line between their neighbours, over the
/// time between these.
PointRange farthest_run(const Track& points, const PointRange& jump) {
  PointRange farthest = jump;
  double max_distance = -1.0;
  for (std::size_t first = jump.first; first <= jump.last; ++first) {
    double sum_s = 0.0;
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    for (std::size_t last = first; last <= jump.last; ++last) {
      if (points[last].time_s - points[first].time_s > max_run_s) break;
      sum_s += points[last].time_s, sum_m += points[last].position_m;
      const auto count = static_cast<double>(last - first + 1);
      const auto &before = points[first - 1], &after = points[last + 1];
      const double gap_s = after.time_s - before.time_s,
                   part = (sum_s / count - before.time_s) / gap_s;
      const Eigen::Vector3d line_m = (1.0 - part) * before.position_m + part * after.position_m;
      const double distance = (sum_m / count - line_m).norm() / gap_s * std::sqrt(count);
      if (distance > max_distance) max_distance = distance, farthest = {first, last};
    }
  }
  return farthest;
}

/// One run of points in each jump of the process noise.
std::vector<PointRange> suspected_runs(const WeightedTrack& track) {
  const auto& points = track.points;
  const auto jumps = [&](std::size_t i) { return track.curve.at(points[i].time_s) > min_jump; };
  std::vector<PointRange> runs;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    if (!jumps(i)) continue;
    const std::size_t first = std::max<std::size_t>(i, 2) - 1;
    while (i + 2 < points.size() && jumps(i + 1)) ++i;
    runs.push_back(farthest_run(points, {first, i}));
  }
  return runs;
}

/// Whether a common error of position explains the points of `range` much better than a motion.
bool has_common_error(const WeightedTrack& track, const PointRange& range, const MotionNoise& noise,
                      const SmoothOptions& options) {
  auto part = part_around(track, range, [](std::size_t) { return true; });
  if (!part) return false;
  estimate_curve(part->without, noise, options);
  const auto motion = smooth_once(part->without, noise, options);
  auto corrected = part->with;
  const auto mean = mean_of(corrected.points, part->range);
  const Eigen::Vector3d error_m = mean.position_m - motion.smoothed(mean.time_s).position_m;
  for (std::size_t i = part->range.first; i <= part->range.last; ++i)
    corrected.points[i].position_m -= error_m;
  corrected.curve = part->without.curve;
  return estimate_curve(part->with, noise, options) - estimate_curve(corrected, noise, options) >
         min_run_advantage;
}

void set_judgement(WeightedTrack& track, const PointRange& range, Judgement judgement) {
  for (std::size_t i = range.first; i <= range.last; ++i)
    if (track.judgements[i] == Judgement::none)
      track.judgements[i] = judgement, track.weights[i] = weight_of(judgement);
}

void judge_points(WeightedTrack& track, const MotionNoise& noise, const SmoothOptions& options) {
  track.judgements.assign(track.points.size(), Judgement::none);
  for (const auto& range : suspected_runs(track))
    if (has_common_error(track, range, noise, options))
      set_judgement(track, range, Judgement::wrong);
  std::vector<PointRange> strikes;
  for (const auto& range : suspected_strikes(track))
    if (is_strike(track, range, noise, options)) strikes.push_back(range);
  for (const auto& range : strikes) set_judgement(track, range, Judgement::right);
}

}  // namespace

void judge_points(std::vector<WeightedTrack>& tracks, const MotionNoise& noise,
                  const SmoothOptions& options) {
  parallel_for(tracks.size(), options.num_threads,
               [&](std::size_t i) { judge_points(tracks[i], noise, options); });
}

}  // namespace touchtrace
