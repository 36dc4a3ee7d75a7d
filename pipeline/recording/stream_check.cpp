#include "pipeline/recording/stream_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace touchtrace {
namespace {

/// Fraction of faulty frames or taxels from which on a glove is useless.
constexpr double useless_fraction = 0.9;

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

bool is_saturated(const GloveInfo& info, std::span<const std::uint16_t> counts, int taxels) {
  const int limit = info.polarity > 0 ? (1 << info.bits) - 1 : 0;
  int saturated = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) saturated += info.mask[i] && counts[i] == limit;
  return 2 * saturated > taxels;
}

int count_dead(const GloveStream& glove) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  int dead = 0;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    if (!glove.info.mask[taxel]) continue;
    bool changed = false;
    for (std::size_t i = taxel; i < glove.counts.size() && !changed; i += taxels)
      changed = glove.counts[i] != glove.counts[taxel];
    dead += !changed;
  }
  return dead;
}

}  // namespace

double StreamTiming::lost_fraction() const {
  return lost == 0 ? 0.0 : static_cast<double>(lost) / static_cast<double>(lost + frames);
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
    if (count > 1) timing.lost += numbers.back() - numbers.front() + 1 - count;
    add_clip(numbers, std::span(host_time_s).subspan(first, count), sums);
  }
  timing.rate_hz = sums.xx / sums.xy;
  const double residual = std::max(0.0, sums.yy - sums.xy * sums.xy / sums.xx);
  timing.jitter_s = std::sqrt(residual / static_cast<double>(sums.frames - sums.lines));
  return timing;
}

TactileCheck check_tactile(const GloveStream& glove) {
  TactileCheck check;
  check.taxels = static_cast<int>(std::count(glove.info.mask.begin(), glove.info.mask.end(), 1));
  check.dead_taxels = count_dead(glove);
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  for (std::size_t frame = 0; frame < glove.frames(); ++frame) {
    const auto counts = std::span(glove.counts).subspan(frame * taxels, taxels);
    const auto fraction = 1.0 / static_cast<double>(glove.frames());
    if (std::ranges::all_of(counts, [](auto c) { return c == 0; })) check.zero_frames += fraction;
    if (is_saturated(glove.info, counts, check.taxels)) check.saturated_frames += fraction;
  }
  return check;
}

std::vector<std::string> TactileCheck::faults() const {
  std::vector<std::string> faults;
  if (zero_frames >= useless_fraction)
    faults.push_back(fmt::format("{:.0f} % of the tactile frames are all zero", 100 * zero_frames));
  if (saturated_frames >= useless_fraction)
    faults.push_back(
        fmt::format("{:.0f} % of the tactile frames are saturated", 100 * saturated_frames));
  if (faults.empty() && dead_taxels >= useless_fraction * taxels)
    faults.push_back(fmt::format("{} of {} taxels have constant counts", dead_taxels, taxels));
  return faults;
}

nlohmann::json to_json(const StreamTiming& timing) {
  return {{"frames", timing.frames},
          {"lost", timing.lost},
          {"lost_share", timing.lost_fraction()},
          {"rate_hz", timing.rate_hz},
          {"jitter_s", timing.jitter_s}};
}

nlohmann::json to_json(const TactileCheck& check) {
  return {{"taxels", check.taxels},
          {"dead_taxels", check.dead_taxels},
          {"zero_frames", check.zero_frames},
          {"saturated_frames", check.saturated_frames}};
}

}  // namespace touchtrace
