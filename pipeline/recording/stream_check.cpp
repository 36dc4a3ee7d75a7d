#include "pipeline/recording/stream_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace touchtrace {
namespace {

/// Sums of the least-squares line host time = offset + period * sequence, one offset per clip.
struct LineSums {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  std::size_t frames = 0, lines = 0;
};

void add_clip(std::span<const std::uint64_t> sequence, std::span<const double> time_s,
              LineSums& sums) {
  if (sequence.size() < 3) return;
  const auto count = static_cast<double>(sequence.size());
  double mean_x = 0.0, mean_y = 0.0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    mean_x += static_cast<double>(sequence[i] - sequence[0]) / count;
    mean_y += (time_s[i] - time_s[0]) / count;
  }
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const double x = static_cast<double>(sequence[i] - sequence[0]) - mean_x;
    const double y = time_s[i] - time_s[0] - mean_y;
    sums.xx += x * x, sums.xy += x * y, sums.yy += y * y;
  }
  sums.frames += sequence.size();
  ++sums.lines;
}

}  // namespace

double StreamTiming::lost_fraction() const {
  return lost == 0 ? 0.0 : static_cast<double>(lost) / static_cast<double>(lost + clip_frames);
}

StreamTiming measure_stream_timing(const std::vector<std::uint64_t>& sequence,
                                   const std::vector<double>& host_time_s,
                                   const std::vector<Clip>& clips) {
  constexpr double forever = std::numeric_limits<double>::infinity();
  const std::vector<Clip> whole{{-forever, forever, {}, false, {}, {}}};
  StreamTiming timing;
  LineSums sums;
  timing.frames = sequence.size();
  for (const auto& clip : clips.empty() ? whole : clips) {
    const auto at = [&](double t) {
      return static_cast<std::size_t>(std::lower_bound(host_time_s.begin(), host_time_s.end(), t) -
                                      host_time_s.begin());
    };
    const std::size_t first = at(clip.start_s), count = at(clip.end_s) - first;
    const auto numbers = std::span(sequence).subspan(first, count);
    timing.clip_frames += count;
    if (count > 1) timing.lost += numbers.back() - numbers.front() + 1 - count;
    add_clip(numbers, std::span(host_time_s).subspan(first, count), sums);
  }
  timing.rate_hz = sums.xx / sums.xy;
  const double residual = std::max(0.0, sums.yy - sums.xy * sums.xy / sums.xx);
  timing.jitter_s = std::sqrt(residual / static_cast<double>(sums.frames - sums.lines));
  return timing;
}

double measured_rate_hz(const GloveStream& glove, const std::vector<Clip>& clips) {
  const double rate_hz = measure_stream_timing(glove.sequence, glove.host_time_s, clips).rate_hz;
  return std::isfinite(rate_hz) ? rate_hz : glove.info.rate_hz;
}

nlohmann::json to_json(const StreamTiming& timing) {
  return {{"frames", timing.frames},
          {"lost", timing.lost},
          {"lost_share", timing.lost_fraction()},
          {"rate_hz", timing.rate_hz},
          {"jitter_s", timing.jitter_s}};
}

}  // namespace touchtrace
