#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

/// Fraction of faulty frames or taxels from which on a glove is useless.
constexpr double useless_fraction = 0.9;
constexpr double max_rest_level = 0.2, max_repeated_frames = 0.1, max_frozen_s = 1.0;
constexpr double quiet_fraction = 0.1;  ///< of the frames: those of the lowest pressure
/// Largest ratio of the changes in even and odd frames if one of them are interpolated.
constexpr double upsampled_ratio = 0.1;
constexpr std::size_t min_upsampled_frames = 20;
constexpr double min_used_range = 0.125;  ///< 3 bits

/// Counts of one glove, frame by frame.
class Frames {
 public:
  explicit Frames(const GloveStream& glove)
      : glove_(glove), taxels_(static_cast<std::size_t>(glove.info.taxels())) {}

  std::size_t size() const { return glove_.frames(); }
  std::size_t taxels() const { return taxels_; }
  bool exists(std::size_t taxel) const { return glove_.info.mask[taxel] != 0; }
  std::span<const std::uint16_t> operator[](std::size_t frame) const {
    return std::span(glove_.counts).subspan(frame * taxels_, taxels_);
  }
  int max_count() const { return (1 << glove_.info.bits) - 1; }
  bool is_saturated(std::uint16_t count) const {
    return count == (glove_.info.polarity > 0 ? max_count() : 0);
  }
  /// Frames `i - 1`, `i` and `i + 1` follow each other without a lost one.
  bool has_neighbours(std::size_t i) const {
    return glove_.sequence[i + 1] - glove_.sequence[i - 1] == 2;
  }
  const GloveStream& glove() const { return glove_; }

 private:
  const GloveStream& glove_;
  std::size_t taxels_;
};

int count_dead(const Frames& frames) {
  int dead = 0;
  for (std::size_t taxel = 0; taxel < frames.taxels(); ++taxel) {
    bool changed = !frames.exists(taxel);
    for (std::size_t i = 1; i < frames.size() && !changed; ++i)
      changed = frames[i][taxel] != frames[0][taxel];
    dead += !changed;
  }
  return dead;
}

/// Mean pressure of the taxels in a frame, fraction of the range.
double mean_pressure(const Frames& frames, std::size_t frame, int taxels) {
  const GloveInfo& info = frames.glove().info;
  double sum = 0.0;
  for (std::size_t i = 0; i < frames.taxels(); ++i)
    if (frames.exists(i)) sum += info.polarity * (frames[frame][i] - info.baseline_counts[i]);
  return sum / (std::max(1, taxels) * frames.max_count());
}

double rest_level(const Frames& frames, int taxels) {
  std::vector<double> levels;
  for (std::size_t i = 0; i < frames.size(); ++i)
    levels.push_back(mean_pressure(frames, i, taxels));
  if (levels.empty()) return 0.0;
  const auto quiet = levels.begin() + static_cast<std::ptrdiff_t>(
                                          quiet_fraction * static_cast<double>(levels.size() - 1));
  std::nth_element(levels.begin(), quiet, levels.end());
  return *quiet;
}

void check_repetitions(const Frames& frames, TactileCheck& check) {
  const auto& time_s = frames.glove().host_time_s;
  std::size_t first = 0, repeated = 0;  // first frame of the current stretch
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (std::ranges::equal(frames[i], frames[i - 1]))
      ++repeated;
    else
      first = i;
    check.frozen_s = std::max(check.frozen_s, time_s[i] - time_s[first]);
  }
  check.repeated_frames =
      static_cast<double>(repeated) / std::max(1.0, static_cast<double>(frames.size()));
}

/// Number of rows or columns that are saturated; `line_of`: row or column of a taxel.
template <class LineOf>
int count_stuck(const Frames& frames, int lines, LineOf line_of) {
  std::vector<double> taxels(static_cast<std::size_t>(lines)), saturated(taxels.size());
  for (std::size_t taxel = 0; taxel < frames.taxels(); ++taxel) {
    if (!frames.exists(taxel)) continue;
    ++taxels[line_of(taxel)];
    for (std::size_t i = 0; i < frames.size(); ++i)
      saturated[line_of(taxel)] += frames.is_saturated(frames[i][taxel]);
  }
  int stuck = 0;
  for (std::size_t i = 0; i < taxels.size(); ++i)
    stuck += saturated[i] > useless_fraction * taxels[i] * static_cast<double>(frames.size());
  return stuck;
}

/// Sums over even or odd frames of squared differences to the previous frame, and to the mean of
/// both neighbours.
struct Changes {
  double repetition[2]{}, interpolation[2]{};
};

Changes sum_changes(const Frames& frames) {
  Changes changes;
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    if (!frames.has_neighbours(i)) continue;
    const std::size_t parity = frames.glove().sequence[i] % 2;
    for (std::size_t t = 0; t < frames.taxels(); ++t) {
      const double change = frames[i][t] - frames[i - 1][t],
                   middle = frames[i][t] - 0.5 * (frames[i - 1][t] + frames[i + 1][t]);
      changes.repetition[parity] += change * change;
      changes.interpolation[parity] += middle * middle;
    }
  }
  return changes;
}

bool is_upsampled(const Frames& frames) {
  if (frames.size() < min_upsampled_frames) return false;
  const Changes changes = sum_changes(frames);
  const auto differ = [](const double(&sums)[2]) {
    return std::min(sums[0], sums[1]) < upsampled_ratio * std::max(sums[0], sums[1]);
  };
  return differ(changes.repetition) || differ(changes.interpolation);
}

void check_levels(const Frames& frames, TactileCheck& check) {
  const double fraction = 1.0 / static_cast<double>(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    int saturated = 0;
    for (std::size_t t = 0; t < frames.taxels(); ++t)
      saturated += frames.exists(t) && frames.is_saturated(frames[i][t]);
    if (std::ranges::all_of(frames[i], [](auto c) { return c == 0; }))
      check.zero_frames += fraction;
    if (2 * saturated > check.taxels) check.saturated_frames += fraction;
  }
}

}  // namespace

TactileCheck check_tactile(const GloveStream& glove) {
  const Frames frames(glove);
  const auto cols = static_cast<std::size_t>(glove.info.cols);
  TactileCheck check;
  check.taxels = static_cast<int>(std::ranges::count(glove.info.mask, 1));
  check.dead_taxels = count_dead(frames);
  check_levels(frames, check);
  check.rest_level = rest_level(frames, check.taxels);
  check_repetitions(frames, check);
  check.stuck_rows = count_stuck(frames, glove.info.rows, [&](std::size_t t) { return t / cols; });
  check.stuck_cols = count_stuck(frames, glove.info.cols, [&](std::size_t t) { return t % cols; });
  check.is_upsampled = is_upsampled(frames);
  if (!glove.counts.empty())
    check.used_range =
        static_cast<double>(*std::ranges::max_element(glove.counts)) / frames.max_count();
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

std::vector<std::string> TactileCheck::warnings() const {
  std::vector<std::string> warnings;
  if (std::abs(rest_level) > max_rest_level)
    warnings.push_back(
        fmt::format("mean pressure at rest is {:.0f} % of the range: baseline or "
                    "polarity is wrong",
                    100 * rest_level));
  if (repeated_frames > max_repeated_frames || frozen_s > max_frozen_s)
    warnings.push_back(
        fmt::format("{:.0f} % of the frames repeat the previous one, for up to "
                    "{:.1f} s",
                    100 * repeated_frames, frozen_s));
  if (stuck_rows > 0 || stuck_cols > 0)
    warnings.push_back(
        fmt::format("{} rows and {} columns are stuck at saturation", stuck_rows, stuck_cols));
  if (is_upsampled)
    warnings.emplace_back(
        "every second frame is interpolated or a repetition: give the native "
        "frames and rate");
  if (used_range < min_used_range)
    warnings.push_back(
        fmt::format("the largest count is {:.1f} % of the range: attribute 'bits' is "
                    "wrong, or the glove was never pressed",
                    100 * used_range));
  return warnings;
}

nlohmann::json to_json(const TactileCheck& check) {
  return {{"taxels", check.taxels},           {"dead_taxels", check.dead_taxels},
          {"zero_frames", check.zero_frames}, {"saturated_frames", check.saturated_frames},
          {"rest_level", check.rest_level},   {"repeated_frames", check.repeated_frames},
          {"frozen_s", check.frozen_s},       {"stuck_rows", check.stuck_rows},
          {"stuck_cols", check.stuck_cols},   {"upsampled", check.is_upsampled},
          {"used_range", check.used_range}};
}

}  // namespace touchtrace
