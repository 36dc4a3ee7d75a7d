#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {
namespace {

// Data never contain the newline that ends a frame.
constexpr std::uint64_t least_byte = '\n' + 1, most_byte = 254;
constexpr std::uint64_t numbers = most_byte - least_byte + 1;  // of frames, before they start anew

}  // namespace

/// [number][two bytes a count, high bits first]["\n"], where an Arduino (10 bits) splits counts
/// after the fifth bit and an ESP32 (12 bits) after the sixth: TouchStreamer.py and
/// read_send_tactile_data.ino of MIT's ActionNet (DelPreto et al. 2022).
std::string actionsense_bytes(const GloveStream& glove, std::size_t frame) {
  const int low_bits = glove.info.bits <= 10 ? 5 : 6;
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string bytes(1, static_cast<char>(least_byte + glove.sequence[frame] % numbers));
  for (std::size_t i = frame * taxels; i < (frame + 1) * taxels; ++i) {
    const unsigned count = glove.counts[i];
    bytes += static_cast<char>(least_byte + (count >> low_bits));
    bytes += static_cast<char>(least_byte + (count & ((1u << low_bits) - 1)));
  }
  return bytes + '\n';
}

}  // namespace touchtrace
