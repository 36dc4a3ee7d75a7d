#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// How a family of gloves sends its frames over a serial line of 8 data bits, no parity, one stop
/// bit. Polarity and range of the counts are the glove's own, not the protocol's.
struct GloveProtocol {
  std::string name, summary;
  int baud;
  int most_bits;  ///< of a count
  /// What the device sends once it has read frame `frame`, a place in the stream. Frames that the
  /// stream lost were sent, too, and lost on the way: their numbers and packets are missing.
  std::string (*bytes_of)(const GloveStream& glove, std::size_t frame);
};

/// Every protocol: one row each, in glove_protocol.cpp.
const std::vector<GloveProtocol>& glove_protocols();
/// Throws usage_error with the known names.
const GloveProtocol& find_glove_protocol(const std::string& name);
std::vector<std::string> glove_protocol_names();

/// Throws data_error if the protocol cannot carry such counts.
void check_carries(const GloveProtocol& protocol, const GloveInfo& info);

// One file each.
std::string actionsense_bytes(const GloveStream& glove, std::size_t frame);
std::string mit_row_bytes(const GloveStream& glove, std::size_t frame);
std::string stag_bytes(const GloveStream& glove, std::size_t frame);
std::string wiresens_bytes(const GloveStream& glove, std::size_t frame);

/// The lowest bytes of `value`, lowest first.
std::string little_endian(std::uint64_t value, int bytes);

}  // namespace touchtrace
