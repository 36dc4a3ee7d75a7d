#include "pipeline/acquire/glove/parser.h"

#include <algorithm>

namespace touchtrace {
namespace {

/// Largest number of successive lost frames; a larger jump is a restart of the device.
constexpr std::uint64_t max_lost_frames = 100'000;

}  // namespace

GloveParser::GloveParser(const GloveInfo& info, FrameSink sink)
    : sink_(std::move(sink)),
      max_count_(static_cast<std::uint16_t>((1u << info.bits) - 1)),
      previous_(static_cast<std::size_t>(info.taxels())) {}

void GloveParser::pass_on(std::uint64_t device_number, std::span<const std::uint16_t> counts,
                          double host_time_s) {
  std::uint64_t sequence = device_number + offset_;
  if (counts_.frames > 0) {
    std::uint64_t lost = sequence - sequence_ - 1;
    if (lost > max_lost_frames) {
      ++counts_.restarts;
      lost = torn_since_;
      offset_ += sequence_ + 1 + lost - sequence;
      sequence = sequence_ + 1 + lost;
    }
    counts_.dropped += lost - std::min(lost, torn_since_);
    counts_.repeated += std::ranges::equal(counts, previous_);
  }
  torn_since_ = 0;
  sequence_ = sequence;
  std::ranges::copy(counts, previous_.begin());
  ++counts_.frames;
  sink_({sequence, host_time_s, previous_});
}

void GloveParser::count_torn(std::uint64_t frames) {
  counts_.torn += frames;
  torn_since_ += frames;
}

}  // namespace touchtrace
