#include <optional>

#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {
namespace {

constexpr std::uint64_t counts_per_packet = 120;

/// Counts by their index since the device started.
class CountsSinceStart {
 public:
  CountsSinceStart(const GloveStream& glove, std::size_t frame)
      : glove_(glove), frame_(frame), taxels_(static_cast<std::uint64_t>(glove.info.taxels())) {}

  /// nullopt in a lost frame. Searches backwards from the given frame.
  std::optional<std::uint16_t> at(std::uint64_t index) const {
    std::size_t frame = frame_;
    while (frame > 0 && glove_.sequence[frame] * taxels_ > index) --frame;
    if (index / taxels_ != glove_.sequence[frame]) return std::nullopt;
    return glove_.counts[frame * taxels_ + index % taxels_];
  }

 private:
  const GloveStream& glove_;
  std::size_t frame_;
  std::uint64_t taxels_;
};

/// Empty if one of its counts is in a lost frame.
std::string packet(const CountsSinceStart& counts, std::uint64_t number, std::uint64_t taxels) {
  const std::uint64_t first = number * counts_per_packet;
  std::string bytes = little_endian(0, 1) + little_endian(first % taxels, 2);
  for (std::uint64_t index = first; index < first + counts_per_packet; ++index) {
    const auto count = counts.at(index);
    if (!count) return {};
    bytes += little_endian(*count, 2);
  }
  return bytes + little_endian(number, 4) + "wr";
}

}  // namespace

/// Packets of 120 counts that cross frame boundaries: [glove, 1 byte][index of the first count in
/// its frame, 2][120 counts, 2 each][packet number, 4]["wr"], low bytes first. A packet is sent
/// when its last count has been read. Source: WiReSens Toolkit (Murphy et al. 2024).
std::string encode_wiresens(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::uint64_t>(glove.info.taxels());
  const CountsSinceStart counts(glove, frame);
  const std::uint64_t start = glove.sequence[frame] * taxels;
  std::string bytes;
  for (std::uint64_t number = start / counts_per_packet;
       (number + 1) * counts_per_packet <= start + taxels; ++number)
    bytes += packet(counts, number, taxels);
  return bytes;
}

}  // namespace touchtrace
