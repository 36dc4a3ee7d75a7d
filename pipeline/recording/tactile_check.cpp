#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "engine/base/statistics.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

/// Fraction of frames or taxels that is nearly all.
constexpr double nearly_all = 0.9;
constexpr double quiet_fraction = 0.1;  ///< of the frames: those of the lowest pressure
/// Largest ratio of the changes in other frames to those in every n-th, if the others are
/// interpolated.
constexpr double upsampled_ratio = 0.1;
constexpr std::size_t min_upsampled_frames = 20;
constexpr double min_contact = 0.02;  ///< of the range

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

/// Taxels of the mask for which `is_faulty(taxel)` is true.
template <class IsFaulty>
std::vector<bool> faulty_taxels(const Frames& frames, IsFaulty is_faulty) {
  std::vector<bool> faulty(frames.taxels());
  for (std::size_t taxel = 0; taxel < faulty.size(); ++taxel)
    faulty[taxel] = frames.exists(taxel) && is_faulty(taxel);
  return faulty;
}

bool is_constant(const Frames& frames, std::size_t taxel) {
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i][taxel] != frames[0][taxel]) return false;
  return true;
}

/// Whether a taxel is saturated in nearly all frames.
bool is_stuck(const Frames& frames, std::size_t taxel) {
  std::size_t saturated = 0;
  for (std::size_t i = 0; i < frames.size(); ++i)
    saturated += frames.is_saturated(frames[i][taxel]);
  return static_cast<double>(saturated) > nearly_all * static_cast<double>(frames.size());
}

/// Number of rows or columns nearly all of whose taxels are faulty; `line_of`: row or column of a
/// taxel.
template <class LineOf>
int count_lines(const Frames& frames, const std::vector<bool>& faulty, int lines, LineOf line_of) {
  std::vector<double> taxels(static_cast<std::size_t>(lines)), faults(taxels.size());
  for (std::size_t taxel = 0; taxel < faulty.size(); ++taxel)
    if (frames.exists(taxel)) ++taxels[line_of(taxel)], faults[line_of(taxel)] += faulty[taxel];
  int count = 0;
  for (std::size_t i = 0; i < taxels.size(); ++i)
    count += taxels[i] > 0.0 && faults[i] > nearly_all * taxels[i];
  return count;
}

void check_taxels(const Frames& frames, TactileCheck& check) {
  const GloveInfo& info = frames.glove().info;
  const auto cols = static_cast<std::size_t>(info.cols);
  const auto row_of = [&](std::size_t taxel) { return taxel / cols; };
  const auto col_of = [&](std::size_t taxel) { return taxel % cols; };
  const auto dead = faulty_taxels(frames, [&](auto taxel) { return is_constant(frames, taxel); }),
             stuck = faulty_taxels(frames, [&](auto taxel) { return is_stuck(frames, taxel); });
  check.dead_taxels = static_cast<int>(std::ranges::count(dead, true));
  check.stuck_taxels = static_cast<int>(std::ranges::count(stuck, true));
  check.dead_rows = count_lines(frames, dead, info.rows, row_of);
  check.dead_cols = count_lines(frames, dead, info.cols, col_of);
  check.stuck_rows = count_lines(frames, stuck, info.rows, row_of);
  check.stuck_cols = count_lines(frames, stuck, info.cols, col_of);
}

/// Fraction of the squared pressure. Noise about the baseline does not count.
double negative_pressure_fraction(const Frames& frames) {
  const GloveInfo& info = frames.glove().info;
  const double min_change = min_contact * frames.max_count();
  double above = 0.0, below = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (std::size_t t = 0; t < frames.taxels(); ++t) {
      const double pressure = info.polarity * (frames[i][t] - info.baseline_counts[t]);
      if (!frames.exists(t) || std::abs(pressure) < min_change) continue;
      (pressure > 0.0 ? above : below) += pressure * pressure;
    }
  return below > 0.0 ? below / (above + below) : 0.0;
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

/// Sums over the taxels of a frame of squared differences to the previous frame, and to the mean of
/// both neighbours.
struct FrameChange {
  std::uint64_t sequence;
  double repetition = 0.0, interpolation = 0.0;
};

std::vector<FrameChange> frame_changes(const Frames& frames) {
  std::vector<FrameChange> changes;
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    if (!frames.has_neighbours(i)) continue;
    FrameChange sums{frames.glove().sequence[i]};
    for (std::size_t t = 0; t < frames.taxels(); ++t) {
      const double change = frames[i][t] - frames[i - 1][t],
                   middle = frames[i][t] - 0.5 * (frames[i - 1][t] + frames[i + 1][t]);
      sums.repetition += change * change, sums.interpolation += middle * middle;
    }
    changes.push_back(sums);
  }
  return changes;
}

/// Whether one of every `factor` frames has nearly all changes, by medians: a few large ones may
/// all be jumps between trials of one length.
bool is_concentrated(const std::vector<FrameChange>& changes, std::size_t factor,
                     double FrameChange::*of) {
  std::vector<std::vector<double>> of_phases(factor);
  for (const FrameChange& change : changes)
    of_phases[change.sequence % factor].push_back(change.*of);
  std::vector<double> medians;
  for (auto& of_phase : of_phases)
    medians.push_back(of_phase.empty() ? 0.0 : median(std::move(of_phase)));
  std::ranges::sort(medians, std::greater());
  return medians[1] < upsampled_ratio * medians[0];
}

/// Number of frames of which all but one are interpolated or repeated; 1: none are.
int upsampling_of(const Frames& frames) {
  if (frames.size() < min_upsampled_frames) return 1;
  const auto changes = frame_changes(frames);
  const auto changed =
      std::ranges::count_if(changes, [](const auto& c) { return c.repetition > 0.0; });
  if (changed < static_cast<std::ptrdiff_t>(min_upsampled_frames)) return 1;
  for (const std::size_t factor : {2, 3, 5, 7})
    if (is_concentrated(changes, factor, &FrameChange::repetition) ||
        is_concentrated(changes, factor, &FrameChange::interpolation))
      return static_cast<int>(factor);
  return 1;
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
  TactileCheck check;
  check.taxels = static_cast<int>(std::ranges::count(glove.info.mask, 1));
  check_taxels(frames, check);
  check_levels(frames, check);
  check.rest_level = rest_level(frames, check.taxels);
  check_repetitions(frames, check);
  check.upsampling = upsampling_of(frames);
  check.negative_pressure_fraction = negative_pressure_fraction(frames);
  if (!glove.counts.empty())
    check.used_range =
        static_cast<double>(*std::ranges::max_element(glove.counts)) / frames.max_count();
  return check;
}

}  // namespace touchtrace
