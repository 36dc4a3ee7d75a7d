#include <optional>

#include "pipeline/acquire/glove/packet_parser.h"
#include "pipeline/acquire/glove/protocol.h"

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

constexpr std::size_t packet_size = 3 + 2 * counts_per_packet + 6;

class WiReSensParser : public PacketParser {
 public:
  WiReSensParser(const GloveInfo& info, FrameSink sink)
      : PacketParser(info, std::move(sink), packet_size, std::uint64_t{1} << 32),
        frame_(taxels()) {}

 private:
  static std::uint64_t start_of(const std::uint8_t* packet) {
    return from_little_endian(packet + 1, 2);
  }

  std::optional<std::uint64_t> number_of(const std::uint8_t* packet) override {
    const std::uint8_t* end = packet + 3 + 2 * counts_per_packet;
    if (packet[0] != 0 || start_of(packet) >= taxels() || end[4] != 'w' || end[5] != 'r') return {};
    for (const std::uint8_t* at = packet + 3; at < end; at += 2)
      if (!is_in_range(from_little_endian(at, 2))) return {};
    return from_little_endian(end, 4);
  }

  void accept(const Packet& packet) override {
    index_ += (packet.advance - 1) * counts_per_packet;
    const std::uint64_t start = start_of(packet.bytes);
    if (packet.advance == 0 || index_ % taxels() != start) {
      const std::uint64_t index = packet.number * counts_per_packet;
      index_ = index % taxels() == start ? index : start;
    }
    for (std::size_t i = 0; i < counts_per_packet; ++i)
      put(static_cast<std::uint16_t>(from_little_endian(packet.bytes + 3 + 2 * i, 2)),
          packet.host_time_s);
  }

  void put(std::uint16_t count, double host_time_s) {
    if (index_ != next_index_) {
      count_torn(std::exchange(num_counts_, 0) > 0 ? 1 : 0);
      next_index_ = index_;
    }
    const std::size_t taxel = index_++ % taxels();
    ++next_index_;
    if (taxel != num_counts_) return;  // the counts before it are missing
    frame_[num_counts_++] = count;
    if (num_counts_ < taxels()) return;
    num_counts_ = 0;
    pass_on((index_ - 1) / taxels(), frame_, host_time_s);
  }

  std::vector<std::uint16_t> frame_;
  std::size_t num_counts_ = 0;                ///< of the current frame
  std::uint64_t index_ = 0, next_index_ = 0;  ///< of counts since the device started
};

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

std::unique_ptr<GloveParser> parse_wiresens(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<WiReSensParser>(info, std::move(sink));
}

}  // namespace touchtrace
