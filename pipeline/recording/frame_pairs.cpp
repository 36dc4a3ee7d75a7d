#include "pipeline/recording/frame_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

double median_interval_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return std::numeric_limits<double>::infinity();
  std::vector<double> intervals(time_s.size() - 1);
  for (std::size_t i = 0; i < intervals.size(); ++i) intervals[i] = time_s[i + 1] - time_s[i];
  return median(std::move(intervals));
}

std::size_t nearest(const std::vector<double>& sorted, double value) {
  const auto next = std::ranges::lower_bound(sorted, value);
  const auto at = static_cast<std::size_t>(next - sorted.begin());
  if (at == 0) return 0;
  return at == sorted.size() || value - sorted[at - 1] < sorted[at] - value ? at - 1 : at;
}

}  // namespace

std::vector<FramePair> pair_frames(const std::vector<double>& color_s,
                                   const std::vector<double>& depth_s) {
  std::vector<FramePair> pairs;
  if (color_s.empty()) return pairs;
  const bool same_stamps = color_s == depth_s;  // stamps may repeat
  const double tolerance_s = std::max(median_interval_s(color_s), median_interval_s(depth_s)) / 2;
  for (std::size_t i = 0; i < depth_s.size(); ++i) {
    const std::size_t color = same_stamps ? i : nearest(color_s, depth_s[i]);
    if (std::abs(color_s[color] - depth_s[i]) <= tolerance_s) pairs.push_back({color, i});
  }
  return pairs;
}

double rate_of(const std::vector<double>& time_s, double fallback) {
  if (time_s.size() < 2) return fallback;
  const double median_s = median_interval_s(time_s);
  if (median_s > 0.0) return 1.0 / median_s;
  const double span_s = time_s.back() - time_s.front();
  return span_s > 0.0 ? static_cast<double>(time_s.size() - 1) / span_s : fallback;
}

bool is_pause(double gap_s, double rate_hz) {
  constexpr double min_pause_s = 0.5, min_pause_frames = 5.0;
  return gap_s > std::max(min_pause_s, min_pause_frames / rate_hz);
}

void fill_sequence(std::vector<std::uint64_t>& sequence, const std::vector<double>& time_s,
                   double rate_hz) {
  constexpr double max_step = 2e8;  // is refused as a counter
  if (!sequence.empty() || time_s.empty()) return;
  sequence.push_back(0);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double gap_s = time_s[i] - time_s[i - 1];
    const double step =
        is_pause(gap_s, rate_hz) ? std::min(max_step, std::round(gap_s * rate_hz)) : 1.0;
    sequence.push_back(sequence.back() + static_cast<std::uint64_t>(step));
  }
}

}  // namespace touchtrace
