#include "pipeline/acquire/glove_protocol.h"

namespace touchtrace {

/// One packet per row: [glove, 1 byte][row, 1 byte][2 bytes per count, low byte first]["wr"].
/// Frames have no number.
std::string encode_mit_rows(const GloveStream& glove, std::size_t frame) {
  const auto rows = static_cast<std::size_t>(glove.info.rows),
             cols = static_cast<std::size_t>(glove.info.cols);
  std::string bytes;
  for (std::size_t row = 0; row < rows; ++row) {
    bytes += '\0';
    bytes += static_cast<char>(row);
    for (std::size_t col = 0; col < cols; ++col)
      bytes += little_endian(glove.counts[(frame * rows + row) * cols + col], 2);
    bytes += "wr";
  }
  return bytes;
}

}  // namespace touchtrace
