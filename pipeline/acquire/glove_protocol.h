#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Serial protocol of a family of gloves: 8 data bits, no parity, 1 stop bit. Byte layouts and
/// sources: pipeline/acquire/README.md. Polarity and range of the counts depend on the glove.
struct GloveProtocol {
  std::string name, summary;
  int baud;
  int max_bits;  ///< of a count
  /// Returns the bytes that the device sends after reading the frame at index `frame`. Frames
  /// missing in the stream count as sent and lost: their frame and packet numbers are skipped.
  std::string (*encode)(const GloveStream& glove, std::size_t frame);
};

/// All protocols; a new one is a row in glove_protocol.cpp.
const std::vector<GloveProtocol>& glove_protocols();
/// Throws usage_error that lists the known names.
const GloveProtocol& find_glove_protocol(const std::string& name);
std::vector<std::string> glove_protocol_names();

/// Throws data_error if the glove's counts have more bits than the protocol transmits.
void require_supported(const GloveProtocol& protocol, const GloveInfo& info);

std::string encode_actionsense(const GloveStream& glove, std::size_t frame);
std::string encode_mit_rows(const GloveStream& glove, std::size_t frame);
std::string encode_stag(const GloveStream& glove, std::size_t frame);
std::string encode_wiresens(const GloveStream& glove, std::size_t frame);

/// Lowest `bytes` bytes of `value`, lowest first.
std::string little_endian(std::uint64_t value, int bytes);

}  // namespace touchtrace
