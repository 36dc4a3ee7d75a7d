#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/acquire/import/byte_reader.h"

namespace touchtrace {

/// Content of an LZ4 frame (github.com/lz4/lz4, doc/lz4_Frame_format.md), of exactly `size` bytes.
/// Checksums are not verified. Throws std::exception for an invalid frame. Safe for untrusted
/// bytes.
std::vector<std::uint8_t> decode_lz4_frame(ByteSpan frame, std::size_t size);

}  // namespace touchtrace
