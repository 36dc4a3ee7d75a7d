#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {
namespace {

// Data bytes are offset so that none is the newline that ends a frame.
constexpr std::uint64_t min_byte = '\n' + 1, max_byte = 254;
constexpr std::uint64_t num_frame_numbers = max_byte - min_byte + 1;

}  // namespace

/// [frame number][2 bytes per count, high bits first]["\n"]. An Arduino (10 bits) splits a count
/// into 5 + 5 bits, an ESP32 (12 bits) into 6 + 6. Source: TouchStreamer.py and
/// read_send_tactile_data.ino of MIT's ActionNet (DelPreto et al. 2022).
std::string encode_actionsense(const GloveStream& glove, std::size_t frame) {
  const int low_bits = glove.info.bits <= 10 ? 5 : 6;
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string bytes(1, static_cast<char>(min_byte + glove.sequence[frame] % num_frame_numbers));
  for (std::size_t i = frame * taxels; i < (frame + 1) * taxels; ++i) {
    const unsigned count = glove.counts[i];
    bytes += static_cast<char>(min_byte + (count >> low_bits));
    bytes += static_cast<char>(min_byte + (count & ((1u << low_bits) - 1)));
  }
  return bytes + '\n';
}

}  // namespace touchtrace
