#include "pipeline/acquire/import/glove_import.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/baseline.h"
#include "pipeline/acquire/glove/learn_glove.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr float max_count = 65535.0f;
constexpr double default_glove_rate_hz = 15.0, max_glove_rate_hz = 1000.0;
constexpr double min_pause_s = 0.5, min_pause_frames = 5.0;  // as `record`

void require_counts(const GloveFile& glove) {
  const auto bad = std::ranges::find_if(
      glove.values, [](float value) { return !(value >= 0.0f && value <= max_count); });
  if (bad == glove.values.end()) return;
  throw data_error(
      fmt::format("frame {} of the glove has the value {}",
                  static_cast<std::size_t>(bad - glove.values.begin()) / glove.taxels(), *bad),
      "give counts of a converter from 0 to 65535, or pressures from 0 to 1");
}

/// Whole counts. Pressures from 0 to 1 become counts of 16 bits.
std::vector<std::uint16_t> counts_of(const GloveFile& glove) {
  require_counts(glove);
  const bool is_whole =
      std::ranges::all_of(glove.values, [](float v) { return v == std::floor(v); });
  const bool is_fraction = !is_whole && std::ranges::max(glove.values) <= 1.0f;
  if (!is_whole)
    Progress::report(is_fraction ? "glove: pressures from 0 to 1 become counts of 16 bits"
                                 : "glove: values are rounded to whole counts");
  std::vector<std::uint16_t> counts;
  counts.reserve(glove.values.size());
  for (const float value : glove.values)
    counts.push_back(
        static_cast<std::uint16_t>(std::lround(is_fraction ? value * max_count : value)));
  return counts;
}

/// Frames whose stamp is not before that of the previous one.
std::vector<std::size_t> ordered_frames(const std::vector<double>& time_s) {
  std::vector<std::size_t> frames;
  double last_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (!(time_s[i] >= last_s)) continue;
    last_s = time_s[i];
    frames.push_back(i);
  }
  if (frames.size() < time_s.size())
    Progress::report(
        fmt::format("warning: left out {} of {} glove frames: their stamps run backward",
                    time_s.size() - frames.size(), time_s.size()));
  if (2 * frames.size() < time_s.size())
    throw data_error("most stamps of the glove run backward", "check the column of the time");
  return frames;
}

/// Inverse of the mean interval, without the intervals of lost frames. The median would be wrong
/// for a device whose packets are not whole frames: its intervals have two values.
double plausible_glove_rate_hz(const std::vector<double>& time_s) {
  const double typical_s = 1.0 / rate_of(time_s, default_glove_rate_hz);
  double sum_s = 0.0;
  int count = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double interval_s = time_s[i] - time_s[i - 1];
    if (interval_s < 0.5 * typical_s || interval_s > 1.5 * typical_s) continue;
    sum_s += interval_s, ++count;
  }
  const double rate_hz = count > 0 ? count / sum_s : 1.0 / typical_s;
  if (rate_hz > max_glove_rate_hz)
    throw data_error(fmt::format("the stamps say {:.3g} glove frames per second", rate_hz),
                     "check the column of the time: stamps are times in seconds");
  return rate_hz;
}

/// Frame counter: adds 1 per frame, and as many frames as fit in a pause.
std::vector<std::uint64_t> counted_frames(const std::vector<double>& time_s, double rate_hz) {
  std::vector<std::uint64_t> sequence{0};
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double gap_s = time_s[i] - time_s[i - 1];
    const bool is_pause = gap_s > std::max(min_pause_s, min_pause_frames / rate_hz);
    sequence.push_back(sequence.back() +
                       (is_pause ? static_cast<std::uint64_t>(std::llround(gap_s * rate_hz)) : 1));
  }
  return sequence;
}

int bits_of(const std::vector<std::uint16_t>& counts) {
  const unsigned largest = std::ranges::max(counts);
  for (const int bits : {8, 10, 12, 14})
    if (largest < 1u << bits) return bits;
  return 16;
}

GloveStream stream_of(const GloveFile& file, double offset_s) {
  GloveStream glove;
  const auto counts = counts_of(file);
  const auto taxels = static_cast<std::ptrdiff_t>(file.taxels());
  for (const std::size_t frame : ordered_frames(file.time_s)) {
    glove.host_time_s.push_back(file.time_s[frame] + offset_s);
    const auto first = counts.begin() + static_cast<std::ptrdiff_t>(frame) * taxels;
    glove.counts.insert(glove.counts.end(), first, first + taxels);
  }
  glove.info.name = "imported";
  glove.info.rows = file.rows, glove.info.cols = file.cols;
  glove.info.rate_hz = plausible_glove_rate_hz(glove.host_time_s);
  glove.info.mask.assign(file.taxels(), 1);
  glove.info.taxel_position_m.assign(3 * file.taxels(), std::nanf(""));
  glove.sequence = counted_frames(glove.host_time_s, glove.info.rate_hz);
  return glove;
}

/// Polarity from the changes after the time at rest.
int learned_polarity(const GloveStream& glove, double rest_s) {
  constexpr double min_ratio = 2.0;
  constexpr std::size_t min_frames = 20;
  constexpr const char* hint =
      "give --polarity 1 (counts increase with pressure) or -1, or other --rest-seconds";
  const double end_s = glove.host_time_s.front() + rest_s;
  const auto rest_frames =
      std::ranges::lower_bound(glove.host_time_s, end_s) - glove.host_time_s.begin();
  const auto num_rest = static_cast<std::size_t>(rest_frames);
  if (num_rest < min_frames || glove.frames() - num_rest < min_frames)
    throw data_error(fmt::format("{} glove frames at rest and {} after them are too few to learn "
                                 "the polarity",
                                 num_rest, glove.frames() - num_rest),
                     hint);
  const auto split = glove.counts.begin() + rest_frames * glove.info.taxels();
  const LearnedGlove learned =
      learn_glove(glove.info, {glove.counts.begin(), split}, {split, glove.counts.end()});
  if (learned.polarity_ratio < min_ratio)
    throw data_error(
        fmt::format("the polarity of the glove is not clear: counts change {:.1f} times as much in "
                    "one direction as in the other",
                    learned.polarity_ratio),
        hint);
  return learned.polarity;
}

void estimate_info(GloveStream& glove, const GloveOptions& options) {
  GloveInfo& info = glove.info;
  info.bits = options.bits > 0 ? options.bits : bits_of(glove.counts);
  info.polarity =
      options.polarity != 0 ? options.polarity : learned_polarity(glove, options.rest_s);
  if (options.baseline_counts >= 0.0)
    info.baseline_counts.assign(static_cast<std::size_t>(info.taxels()),
                                static_cast<float>(options.baseline_counts));
  else
    info.baseline_counts = resting_baseline(glove, options.rest_s);
  Progress::report(fmt::format(
      "glove: {} x {} taxels at {:.1f} Hz, {} bits{}, polarity {:+d}{}, baseline {}", info.rows,
      info.cols, info.rate_hz, info.bits, options.bits > 0 ? "" : " (of the largest count)",
      info.polarity, options.polarity != 0 ? "" : " (learnt)",
      options.baseline_counts >= 0.0 ? "given" : "of the time at rest"));
}

}  // namespace

GloveStream import_glove(const GloveOptions& options) {
  GloveStream glove = stream_of(read_glove_file(options.file, options.layout), options.offset_s);
  estimate_info(glove, options);
  return glove;
}

}  // namespace touchtrace
