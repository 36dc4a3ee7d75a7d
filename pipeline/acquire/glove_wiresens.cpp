#include <optional>

#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {
namespace {

constexpr std::uint64_t nodes_a_packet = 120;

/// A count by its place among all that the device ever read.
class CountsRead {
 public:
  CountsRead(const GloveStream& glove, std::size_t frame)
      : glove_(glove), frame_(frame), taxels_(static_cast<std::uint64_t>(glove.info.taxels())) {}

  /// None: in a frame that was lost.
  std::optional<std::uint16_t> at(std::uint64_t place) const {
    std::size_t frame = frame_;
    while (frame > 0 && glove_.sequence[frame] * taxels_ > place) --frame;
    if (place / taxels_ != glove_.sequence[frame]) return std::nullopt;
    return glove_.counts[frame * taxels_ + place % taxels_];
  }

 private:
  const GloveStream& glove_;
  std::size_t frame_;
  std::uint64_t taxels_;
};

/// Nothing if it began in a frame that was lost.
std::string packet(const CountsRead& counts, std::uint64_t number, std::uint64_t taxels) {
  const std::uint64_t first = number * nodes_a_packet;
  std::string bytes = little_endian(0, 1) + little_endian(first % taxels, 2);
  for (std::uint64_t place = first; place < first + nodes_a_packet; ++place) {
    const auto count = counts.at(place);
    if (!count) return {};
    bytes += little_endian(*count, 2);
  }
  return bytes + little_endian(number, 4) + "wr";
}

}  // namespace

/// Packets go on from one frame to the next: [glove, 1 byte][place of the first count in its frame,
/// 2][120 counts, 2 each][number of the packet, 4]["wr"], low bytes first. Each is sent once its
/// last count is read (Murphy et al. 2024).
std::string wiresens_bytes(const GloveStream& glove, std::size_t frame) {
  const auto taxels = static_cast<std::uint64_t>(glove.info.taxels());
  const CountsRead counts(glove, frame);
  const std::uint64_t begins = glove.sequence[frame] * taxels;
  std::string bytes;
  for (std::uint64_t number = begins / nodes_a_packet;
       (number + 1) * nodes_a_packet <= begins + taxels; ++number)
    bytes += packet(counts, number, taxels);
  return bytes;
}

}  // namespace touchtrace
