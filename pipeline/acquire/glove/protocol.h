#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/acquire/glove/parser.h"

namespace touchtrace {

/// Serial protocol of a family of gloves: 8 data bits, no parity, 1 stop bit. Byte layouts and
/// sources: pipeline/acquire/README.md. Polarity and range of the counts depend on the glove.
struct GloveProtocol {
  std::string name, summary;
  int baud;
  int max_bits;  ///< of a count
  /// Returns the bytes that the device sends after reading the frame at index `frame`. Frames
  /// missing in the stream count as sent and lost: their frame and packet numbers are skipped.
  std::function<std::string(const GloveStream& glove, std::size_t frame)> encode;
  /// Returns a parser of the bytes of a glove with this layout and number of bits.
  std::function<std::unique_ptr<GloveParser>(const GloveInfo& info, FrameSink sink)> parse;
  GloveInfo usual_glove;     ///< layout, rate, bits and polarity of the usual device
  int fixed_taxels = 0;      ///< 0: any number
  std::string request = {};  ///< bytes that ask the device for a frame; empty: it sends by itself
  bool holds_lines_low = false;  ///< DTR and RTS, which would reset the device
  bool has_numbers = false;      ///< of frames or packets, which tell how many were lost
};

/// All protocols; a new one is a row in protocol.cpp.
const std::vector<GloveProtocol>& glove_protocols();
/// Protocol of that name, or of a file that ends in .toml (see own_protocol.h). Throws usage_error
/// that lists the known names, and data_error for an invalid file.
const GloveProtocol& find_glove_protocol(const std::string& name);
std::vector<std::string> glove_protocol_names();

/// Throws data_error if the protocol cannot transmit as many bits or taxels as the glove has.
void require_supported(const GloveProtocol& protocol, const GloveInfo& info);

std::string encode_actionsense(const GloveStream& glove, std::size_t frame);
std::string encode_mit_rows(const GloveStream& glove, std::size_t frame);
std::string encode_stag(const GloveStream& glove, std::size_t frame);
std::string encode_wiresens(const GloveStream& glove, std::size_t frame);
std::string encode_vitac(const GloveStream& glove, std::size_t frame);
std::string encode_jq20(const GloveStream& glove, std::size_t frame);

std::unique_ptr<GloveParser> parse_actionsense(const GloveInfo& info, FrameSink sink);
std::unique_ptr<GloveParser> parse_mit_rows(const GloveInfo& info, FrameSink sink);
std::unique_ptr<GloveParser> parse_stag(const GloveInfo& info, FrameSink sink);
std::unique_ptr<GloveParser> parse_wiresens(const GloveInfo& info, FrameSink sink);
std::unique_ptr<GloveParser> parse_vitac(const GloveInfo& info, FrameSink sink);
std::unique_ptr<GloveParser> parse_jq20(const GloveInfo& info, FrameSink sink);

/// Lowest `bytes` bytes of `value`, lowest first.
std::string little_endian(std::uint64_t value, int bytes);

}  // namespace touchtrace
