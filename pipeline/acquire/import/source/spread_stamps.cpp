#include "pipeline/acquire/import/source/spread_stamps.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/progress.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr double max_repeated_fraction = 0.1;
constexpr double max_interval_ratio = 1.5;  // of intervals without a pause to the typical one

/// Frames with the same stamp.
struct StampGroup {
  std::size_t first, count;
  double time_s, interval_s;  ///< interval_s: to the next stamp, or the typical one
};

std::vector<StampGroup> groups_of(const std::vector<double>& time_s) {
  std::vector<StampGroup> groups;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (!groups.empty() && groups.back().time_s == time_s[i])
      ++groups.back().count;
    else
      groups.push_back({i, 1, time_s[i], 0.0});
  }
  return groups;
}

/// Sets the intervals. Returns the typical time between frames.
double set_intervals(std::vector<StampGroup>& groups) {
  std::vector<double> intervals, periods;
  for (std::size_t i = 0; i + 1 < groups.size(); ++i)
    intervals.push_back(groups[i + 1].time_s - groups[i].time_s);
  const double typical_s = median(intervals);
  intervals.push_back(typical_s);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    groups[i].interval_s = intervals[i] > max_interval_ratio * typical_s ? typical_s : intervals[i];
    periods.push_back(groups[i].interval_s / static_cast<double>(groups[i].count));
  }
  return median(std::move(periods));
}

void spread(const StampGroup& group, double start_s, double period_s, std::vector<double>& time_s) {
  for (std::size_t i = 0; i < group.count; ++i)
    time_s[group.first + i] = start_s + static_cast<double>(i) * period_s;
}

}  // namespace

bool spread_repeated_stamps(std::vector<double>& time_s) {
  auto groups = groups_of(time_s);
  const std::size_t repeated = time_s.size() - groups.size();
  if (groups.size() < 3 ||
      static_cast<double>(repeated) <= max_repeated_fraction * static_cast<double>(time_s.size()))
    return false;
  const double typical_s = set_intervals(groups);
  for (const StampGroup& group : groups) {
    const auto count = static_cast<double>(group.count);
    const bool is_end = &group == &groups.front() || &group == &groups.back();
    const double period_s =
        is_end ? std::min(typical_s, group.interval_s / count) : group.interval_s / count;
    const bool is_first = &group == &groups.front();
    spread(group, group.time_s + (is_first ? group.interval_s - count * period_s : 0.0), period_s,
           time_s);
  }
  Progress::warn(
      fmt::format("{} of {} glove frames repeat the stamp before them: their "
                  "times are spread evenly until the next stamp",
                  repeated, time_s.size()));
  return true;
}

double rate_without_pauses_hz(const std::vector<double>& time_s) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time_s.size(); ++i) intervals.push_back(time_s[i] - time_s[i - 1]);
  const double typical_s = median(intervals);
  std::erase_if(intervals, [&](double s) { return s > 5.0 * typical_s; });
  double sum_s = 0.0;
  for (const double interval_s : intervals) sum_s += interval_s;
  return static_cast<double>(intervals.size()) / sum_s;
}

}  // namespace touchtrace
