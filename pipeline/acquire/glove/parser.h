#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Frame of a glove; valid during the call.
struct GloveFrame {
  std::uint64_t sequence;  ///< strictly increasing; the frames that it skips were lost
  double host_time_s;      ///< arrival of the last byte
  std::span<const std::uint16_t> counts;  ///< [rows, cols]
};

using FrameSink = std::function<void(const GloveFrame&)>;

/// Numbers of frames that a parser has found.
struct ParserCounts {
  std::uint64_t frames = 0;         ///< passed on
  std::uint64_t dropped = 0;        ///< skipped by the device's numbers, without the torn ones
  std::uint64_t torn = 0;           ///< with missing or invalid bytes
  std::uint64_t repeated = 0;       ///< passed on, with the counts of the previous frame
  std::uint64_t restarts = 0;       ///< jumps of the device's numbers that cannot be lost frames
  std::uint64_t skipped_bytes = 0;  ///< that belong to no frame
  std::uint64_t out_of_range = 0;   ///< packets or lines refused for a count beyond the converter
};

/// Parser of the bytes of one glove. Does not allocate after its construction.
class GloveParser {
 public:
  GloveParser(const GloveInfo& info, FrameSink sink);
  virtual ~GloveParser() = default;
  GloveParser(const GloveParser&) = delete;
  GloveParser& operator=(const GloveParser&) = delete;

  /// Parses a piece of any size that arrived at `host_time_s`; passes complete frames on.
  virtual void feed(std::span<const std::uint8_t> bytes, double host_time_s) = 0;
  /// Passes on a last frame that waits for bytes behind it. To be called when no bytes follow.
  virtual void finish(double /*host_time_s*/) {}
  const ParserCounts& counts() const { return counts_; }

 protected:
  std::size_t taxels() const { return previous_.size(); }
  std::uint16_t max_count() const { return max_count_; }
  /// Whether the converter can have the count; counts the packets in which it cannot.
  bool is_in_range(std::uint64_t count) {
    counts_.out_of_range += count > max_count_;
    return count <= max_count_;
  }
  void pass_on(std::uint64_t device_number, std::span<const std::uint16_t> counts,
               double host_time_s);
  void count_torn(std::uint64_t frames);
  void count_skipped(std::size_t bytes) { counts_.skipped_bytes += bytes; }

 private:
  FrameSink sink_;
  ParserCounts counts_;
  std::uint16_t max_count_;
  std::vector<std::uint16_t> previous_;
  std::uint64_t sequence_ = 0, offset_ = 0;  ///< offset_: of the sequence from the device's numbers
  std::uint64_t torn_since_ = 0;             ///< torn frames since the last one passed on
};

}  // namespace touchtrace
