#include "pipeline/acquire/import/gloves/glove_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/source/spread_stamps.h"
#include "pipeline/acquire/stamp_unit.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr double default_glove_rate_hz = 15.0, min_glove_rate_hz = 0.5, max_glove_rate_hz = 1000.0;
constexpr double max_span_s = 1e6;           // of a recording
constexpr std::size_t max_wrong_stamps = 5;  // in a row
constexpr double max_deviation = 0.25;       // of an interval from whole periods, in periods
constexpr double min_regular_fraction = 0.95, max_missing_fraction = 0.1;
constexpr const char* hint =
    "check which column or array has the times, and name it with its unit, such as time_ms";

[[noreturn]] void reject_rate(double per_stamp) {
  throw data_error(fmt::format("the median interval of the glove's stamps is {:.3g}: in s, ms, us "
                               "and ns that is not 0.5 to 1000 frames per second",
                               1.0 / per_stamp),
                   hint);
}

/// Continues counters of 32 bits that start again at 0, as Arduino's micros() does after 71
/// minutes.
void unwrap(std::vector<double>& stamps) {
  for (const double per_unit : {1.0, 1e3, 1e6}) {
    const double period = 4294967296.0 / per_unit;
    if (std::ranges::any_of(stamps, [&](double stamp) { return stamp >= period; })) continue;
    double turns = 0.0;
    for (std::size_t i = 1, last = 0; i < stamps.size(); last = i++) {
      const bool restarts =
          stamps[last] - turns * period > 0.9 * period && stamps[i] < 0.1 * period;
      stamps[i] += period * (turns += restarts);
    }
    if (turns == 0.0) continue;
    Progress::report("glove: the stamps start again at 0 after 2^32: continued");
    return;
  }
}

/// Seconds of all stamps.
std::vector<double> seconds_of(const GloveFile& file) {
  std::vector<double> time_s = file.time_s;
  unwrap(time_s);
  if (file.has_time_unit) return time_s;
  const auto unit = stamp_unit(time_s, min_glove_rate_hz);
  if (!unit) reject_rate(frames_per_stamp(time_s));
  const double rate_hz = frames_per_stamp(time_s) * unit->per_second;
  const bool could_be_other = 1e3 * rate_hz <= max_glove_rate_hz;  // the next smaller unit
  if (unit->per_second == 1.0 && !could_be_other) return time_s;
  Progress::report(
      fmt::format("glove: stamps are taken as {}, {:.3g} frames per second", unit->name, rate_hz));
  for (double& stamp : time_s) stamp /= unit->per_second;
  return time_s;
}

/// Number of last frames to leave out, so that a stamp is not before the last one; nullopt if there
/// are too many: then this stamp is the wrong one.
std::optional<std::size_t> frames_before(const std::vector<std::size_t>& frames,
                                         const std::vector<double>& time_s, double stamp_s) {
  for (std::size_t count = 0; count <= max_wrong_stamps; ++count)
    if (count >= frames.size() || stamp_s >= time_s[frames[frames.size() - 1 - count]])
      return std::min(count, frames.size());
  return std::nullopt;
}

/// Whether frame `i` only changed places with the last one of `frames`: its stamp is before that
/// one's and no earlier than that of the frame before, and the next stamp is after both.
bool is_swapped(const std::vector<std::size_t>& frames, const std::vector<double>& time_s,
                std::size_t i) {
  if (frames.empty() || time_s[i] >= time_s[frames.back()]) return false;
  if (frames.size() > 1 && time_s[i] < time_s[frames[frames.size() - 2]]) return false;
  const auto next = std::find_if(time_s.begin() + static_cast<std::ptrdiff_t>(i) + 1, time_s.end(),
                                 [](double stamp) { return std::isfinite(stamp); });
  return next != time_s.end() && *next >= time_s[frames.back()];
}

/// Frames in the order of their stamps, without those with a missing or wrong stamp: one that is
/// before the previous ones, or up to five that are after the next one. Swapped neighbours are put
/// in order.
std::vector<std::size_t> ordered_frames(const std::vector<double>& time_s) {
  std::vector<std::size_t> frames;
  std::size_t num_swapped = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (!std::isfinite(time_s[i])) continue;
    if (is_swapped(frames, time_s, i)) {
      frames.insert(frames.end() - 1, i);
      ++num_swapped;
      continue;
    }
    const auto wrong = frames_before(frames, time_s, time_s[i]);
    if (!wrong) continue;
    frames.resize(frames.size() - *wrong);
    frames.push_back(i);
  }
  if (num_swapped > 0)
    Progress::warn(fmt::format(
        "{} of {} glove frames are stored after the next one: put in the order of their stamps",
        num_swapped, time_s.size()));
  if (frames.size() < time_s.size()) {
    std::size_t first = 0;
    while (first < frames.size() && frames[first] == first) ++first;
    Progress::warn(fmt::format(
        "skipped {} of {} glove frames, the first one is frame {}: their stamps run backward or "
        "are missing",
        time_s.size() - frames.size(), time_s.size(), first));
  }
  if (2 * frames.size() < time_s.size())
    throw data_error("most stamps of the glove run backward or are missing", hint);
  return frames;
}

/// Inverse of the mean interval, without the intervals of lost frames. The median would be wrong
/// for a device whose packets are not whole frames: its intervals have two values.
double glove_rate_hz(const std::vector<double>& time_s) {
  const double typical_s = 1.0 / rate_of(time_s, default_glove_rate_hz);
  double sum_s = 0.0;
  int count = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double interval_s = time_s[i] - time_s[i - 1];
    if (interval_s < 0.5 * typical_s || interval_s > 1.5 * typical_s) continue;
    sum_s += interval_s, ++count;
  }
  return count > 0 ? count / sum_s : 1.0 / typical_s;
}

void require_plausible(double rate_hz) {
  if (rate_hz > max_glove_rate_hz)
    throw data_error(fmt::format("the stamps say {:.3g} glove frames per second", rate_hz), hint);
}

void require_span(const std::vector<double>& time_s) {
  const double span_s = time_s.back() - time_s.front();
  if (span_s > max_span_s || (span_s == 0.0 && time_s.size() > 1))
    throw data_error(fmt::format("the times of {} glove frames span {:g} s", time_s.size(), span_s),
                     hint);
}

/// Frame counter: adds `step(i)` per frame, and as many frames as fit in a pause that it skips.
template <class Step>
std::vector<std::uint64_t> counted_frames(const GloveTimes& times, Step&& step) {
  std::vector<std::uint64_t> sequence{0};
  for (std::size_t i = 1; i < times.time_s.size(); ++i) {
    const double gap_s = times.time_s[i] - times.time_s[i - 1];
    const auto fitting = static_cast<std::uint64_t>(std::llround(gap_s * times.rate_hz));
    const std::uint64_t counted = step(i);
    const bool is_skipped = is_pause(gap_s, times.rate_hz) && 2 * counted < fitting;
    sequence.push_back(sequence.back() + (is_skipped ? fitting : counted));
  }
  return sequence;
}

/// Whether the numbers of a file count its frames: they increase, by 1 in most frames.
bool counts_frames(const std::vector<std::uint64_t>& numbers,
                   const std::vector<std::size_t>& frames) {
  std::size_t single_steps = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (numbers[frames[i]] <= numbers[frames[i - 1]]) return false;
    single_steps += numbers[frames[i]] - numbers[frames[i - 1]] == 1;
  }
  return 2 * single_steps + 1 >= frames.size();
}

/// Number of periods in the interval before a frame; at least 1.
std::uint64_t periods_before(const GloveTimes& times, std::size_t frame) {
  const double interval_s = times.time_s[frame] - times.time_s[frame - 1];
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::llround(interval_s * times.rate_hz)));
}

/// Whether the stamps show which frames are missing: nearly all intervals, pauses aside, are whole
/// periods, and few frames are missing. Packets of several frames also have two kinds of intervals.
bool are_regular(const GloveTimes& times) {
  double intervals = 0.0, whole = 0.0, missing = 0.0;
  for (std::size_t i = 1; i < times.time_s.size(); ++i) {
    const double interval_s = times.time_s[i] - times.time_s[i - 1];
    if (is_pause(interval_s, times.rate_hz)) continue;
    const auto periods = static_cast<double>(periods_before(times, i));
    whole += std::abs(interval_s * times.rate_hz - periods) < max_deviation;
    missing += periods - 1.0;
    ++intervals;
  }
  return whole >= min_regular_fraction * intervals && missing <= max_missing_fraction * intervals;
}

std::vector<std::uint64_t> sequence_of(const GloveFile& file, const GloveTimes& times) {
  const auto& numbers = file.sequence;
  const bool has_numbers = !numbers.empty() && counts_frames(numbers, times.frames);
  if (!numbers.empty() && !has_numbers)
    Progress::warn("the glove's sequence does not count its frames and is not used");
  const bool is_regular = !has_numbers && are_regular(times);
  return counted_frames(times, [&](std::size_t i) -> std::uint64_t {
    if (has_numbers) return numbers[times.frames[i]] - numbers[times.frames[i - 1]];
    return is_regular ? periods_before(times, i) : 1;
  });
}

/// Times of frames by their numbers, which count lost ones; nullopt without such numbers.
std::optional<std::vector<double>> numbered_times(const GloveFile& file) {
  std::vector<std::size_t> all(file.time_s.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (file.counted_rate_hz == 0.0 || file.sequence.empty() || !counts_frames(file.sequence, all))
    return std::nullopt;
  std::vector<double> time_s;
  for (const std::uint64_t number : file.sequence)
    time_s.push_back(static_cast<double>(number - file.sequence[0]) / file.counted_rate_hz);
  return time_s;
}

}  // namespace

GloveTimes glove_times(const GloveFile& file) {
  GloveTimes times;
  const auto numbered_s = numbered_times(file);
  const std::vector<double> time_s = numbered_s ? *numbered_s : seconds_of(file);
  times.frames = ordered_frames(time_s);
  for (const std::size_t frame : times.frames) times.time_s.push_back(time_s[frame]);
  require_span(times.time_s);
  times.rate_hz = spread_repeated_stamps(times.time_s) ? rate_without_pauses_hz(times.time_s)
                                                       : glove_rate_hz(times.time_s);
  require_plausible(times.rate_hz);
  times.sequence = sequence_of(file, times);
  return times;
}

}  // namespace touchtrace
