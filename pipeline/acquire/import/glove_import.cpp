#include "pipeline/acquire/import/glove_import.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/glove/baseline.h"
#include "pipeline/acquire/glove/learn_glove.h"
#include "pipeline/acquire/import/gloves/glove_times.h"
#include "pipeline/acquire/import/gloves/glove_values.h"

namespace touchtrace {
namespace {

constexpr double max_unix_s = 1e11;

int bits_of(const std::vector<std::uint16_t>& counts) {
  const unsigned largest = std::ranges::max(counts);
  for (const int bits : {8, 10, 12, 14})
    if (largest < 1u << bits) return bits;
  return 16;
}

GloveStream stream_of(const GloveFile& file, const ValueScale& scale, double offset_s) {
  GloveStream glove;
  const auto counts = counts_of(file, scale);
  const auto taxels = static_cast<std::ptrdiff_t>(file.taxels());
  GloveTimes times = glove_times(file);
  for (const std::size_t frame : times.frames) {
    const auto first = counts.begin() + static_cast<std::ptrdiff_t>(frame) * taxels;
    glove.counts.insert(glove.counts.end(), first, first + taxels);
  }
  for (const double time_s : times.time_s) glove.host_time_s.push_back(time_s + offset_s);
  glove.sequence = std::move(times.sequence);
  glove.info.name = "imported";
  glove.info.rows = file.rows, glove.info.cols = file.cols;
  glove.info.rate_hz = times.rate_hz;
  glove.info.mask.assign(file.taxels(), 1);
  glove.info.taxel_position_m.assign(3 * file.taxels(), std::nanf(""));
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
                                 "the polarity: {} of each are needed",
                                 num_rest, glove.frames() - num_rest, min_frames),
                     hint);
  const auto split = glove.counts.begin() + rest_frames * glove.info.taxels();
  const LearnedGlove learned =
      learn_glove(glove.info, {glove.counts.begin(), split}, {split, glove.counts.end()});
  if (learned.polarity_ratio == 0.0)
    throw data_error("no taxel of the glove changes by more than its noise after the time at rest",
                     hint);
  if (learned.polarity_ratio < min_ratio)
    throw data_error(
        fmt::format("the polarity of the glove is not clear: counts change {:.2g} times as much in "
                    "one direction as in the other",
                    learned.polarity_ratio),
        hint);
  return learned.polarity;
}

int checked_bits(const GloveStream& glove, const GloveOptions& options, bool is_scaled) {
  const unsigned largest = std::ranges::max(glove.counts);
  if (is_scaled) return 16;
  if (options.bits > 0 && largest >= 1u << options.bits)
    throw data_error(fmt::format("the glove has the count {}, --bits {} ends at {}", largest,
                                 options.bits, (1u << options.bits) - 1),
                     "leave out --bits, or give those of the converter");
  return options.bits > 0 ? options.bits : bits_of(glove.counts);
}

void estimate_info(GloveStream& glove, const GloveOptions& options, const ValueScale& scale) {
  GloveInfo& info = glove.info;
  info.bits = checked_bits(glove, options, scale.is_scaled());
  info.polarity =
      options.polarity != 0 ? options.polarity : learned_polarity(glove, options.rest_s);
  if (options.baseline_counts >= 0.0)
    info.baseline_counts.assign(static_cast<std::size_t>(info.taxels()),
                                static_cast<float>(scale.scaled(options.baseline_counts)));
  else
    info.baseline_counts = resting_baseline(glove, options.rest_s);
  Progress::report(
      fmt::format("glove: {} x {} taxels at {:.1f} Hz, {} bits{}, polarity {:+d}{}, baseline {}",
                  info.rows, info.cols, info.rate_hz, info.bits,
                  options.bits > 0 || scale.is_scaled() ? "" : " (of the largest count)",
                  info.polarity, options.polarity != 0 ? "" : " (learnt)",
                  options.baseline_counts >= 0.0 ? "given" : "of the time at rest"));
}

void require_baseline(const GloveOptions& options) {
  if (options.baseline_counts >= 0.0) return;
  if (options.baseline_counts != -1.0)
    throw usage_error(fmt::format("--baseline {:g} is not a count", options.baseline_counts),
                      "give the counts without contact; -1: medians of the time at rest");
  if (options.rest_s == 0.0)
    throw usage_error("a glove that is never at rest needs a baseline",
                      "give --baseline, the counts without contact, or --rest-seconds");
}

}  // namespace

ImportedGlove import_glove(const GloveOptions& options) {
  require_baseline(options);
  const GloveFile file = read_glove_file(options.file, options.layout);
  const ValueScale scale = value_scale(file, options.bits > 0);
  GloveStream glove = stream_of(file, scale, options.offset_s);
  estimate_info(glove, options, scale);
  const bool has_epoch = file.epoch_unix_s > 0.0 && file.epoch_unix_s < max_unix_s;
  return {std::move(glove), has_epoch ? file.epoch_unix_s : 0.0};
}

}  // namespace touchtrace
