#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/acquire/import/byte_reader.h"

namespace touchtrace {

enum class Compression { none, lz4, bz2 };

/// Compression by its name in a bag; nullopt: unknown.
std::optional<Compression> find_compression(const std::string& name);

/// Content of compressed bytes, of exactly `size` bytes. LZ4: one frame. Throws std::exception for
/// damaged bytes and for another size. Safe for untrusted bytes.
std::vector<std::uint8_t> decompress(Compression compression, ByteSpan stored, std::size_t size);

}  // namespace touchtrace
