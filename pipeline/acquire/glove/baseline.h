#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// [taxels] Median of each taxel over frames at rest [frames, taxels]; zeros without frames.
std::vector<float> median_counts(std::span<const std::uint16_t> frames, std::size_t taxels);

/// [rows, cols] Medians of the counts in the first `rest_s` seconds; zeros if `rest_s` is 0. Needs
/// GloveInfo::rows and cols, and a frame.
std::vector<float> resting_baseline(const GloveStream& glove, double rest_s);

/// Baseline of a glove that is at rest for the first seconds of a stream.
class RestBaseline {
 public:
  RestBaseline(std::size_t taxels, double rest_s) : taxels_(taxels), rest_s_(rest_s) {}

  /// Adds a frame [taxels]. False, and not added: it arrived after the rest.
  bool add(double time_s, std::span<const std::uint16_t> counts);
  /// Median of the frames at rest.
  std::vector<float> baseline() const { return median_counts(frames_, taxels_); }

 private:
  std::size_t taxels_;
  double rest_s_, end_s_ = 0.0;
  std::vector<std::uint16_t> frames_;
};

}  // namespace touchtrace
