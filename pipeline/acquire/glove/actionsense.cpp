#include <algorithm>

#include "pipeline/acquire/glove/packet_parser.h"
#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

// Data bytes are offset so that none is the newline that ends a frame.
constexpr std::uint64_t min_byte = '\n' + 1, max_byte = 254;
constexpr std::uint64_t num_frame_numbers = max_byte - min_byte + 1;

/// An Arduino (10 bits) splits a count into 5 + 5 bits, an ESP32 (12 bits) into 6 + 6.
int low_bits_of(const GloveInfo& info) { return info.bits <= 10 ? 5 : 6; }

class ActionSenseParser : public PacketParser {
 public:
  ActionSenseParser(const GloveInfo& info, FrameSink sink)
      : PacketParser(info, std::move(sink), 2 + 2 * static_cast<std::size_t>(info.taxels()),
                     num_frame_numbers),
        low_bits_(low_bits_of(info)),
        frame_(taxels()) {}

 private:
  std::optional<std::uint64_t> number_of(const std::uint8_t* packet) override {
    const std::size_t data_bytes = 2 * taxels();
    if (packet[data_bytes + 1] != '\n' || packet[0] < min_byte || packet[0] > max_byte) return {};
    for (std::size_t i = 1; i <= data_bytes; ++i)
      if (packet[i] < min_byte || (packet[i] - min_byte) >> low_bits_ != 0) return {};
    return packet[0] - min_byte;
  }

  void accept(const Packet& packet) override {
    if (packet.advance > 1)
      count_torn(std::min<std::uint64_t>(packet.advance - 1, skipped_packets(packet)));
    for (std::size_t i = 0; i < taxels(); ++i)
      frame_[i] = static_cast<std::uint16_t>((packet.bytes[2 * i + 1] - min_byte) << low_bits_ |
                                             (packet.bytes[2 * i + 2] - min_byte));
    number_ = packet.advance == 0 ? packet.number : number_ + packet.advance;
    pass_on(number_, frame_, packet.host_time_s);
  }

  int low_bits_;
  std::vector<std::uint16_t> frame_;
  std::uint64_t number_ = 0;  ///< frames counted without the modulus
};

}  // namespace

/// [frame number][2 bytes per count, high bits first]["\n"]. Source: TouchStreamer.py and
/// read_send_tactile_data.ino of MIT's ActionNet (DelPreto et al. 2022).
std::string encode_actionsense(const GloveStream& glove, std::size_t frame) {
  const int low_bits = low_bits_of(glove.info);
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string bytes(1, static_cast<char>(min_byte + glove.sequence[frame] % num_frame_numbers));
  for (std::size_t i = frame * taxels; i < (frame + 1) * taxels; ++i) {
    const unsigned count = glove.counts[i];
    bytes += static_cast<char>(min_byte + (count >> low_bits));
    bytes += static_cast<char>(min_byte + (count & ((1u << low_bits) - 1)));
  }
  return bytes + '\n';
}

std::unique_ptr<GloveParser> parse_actionsense(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<ActionSenseParser>(info, std::move(sink));
}

}  // namespace touchtrace
