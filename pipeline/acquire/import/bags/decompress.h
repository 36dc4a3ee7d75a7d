#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {

enum class Compression { none, lz4, bz2, zstd };

/// Compression by its name in a bag; nullopt: unknown.
std::optional<Compression> find_compression(const std::string& name);

/// Content of compressed bytes, of exactly `size` bytes, 1 GiB at most. LZ4, zstd: one frame.
/// `none`: the bytes, whatever `size` is. Throws std::exception for damaged bytes and for another
/// size. Safe for untrusted bytes.
std::vector<std::uint8_t> decompress(Compression compression, ByteSpan stored, std::size_t size);

/// Bytes of a message that rosbag2 may have compressed on its own, as a zstd frame, to `buffer`.
/// Throws std::exception for a damaged frame or one of over 256 MiB.
ByteSpan plain_message(ByteSpan stored, std::vector<std::uint8_t>& buffer);

}  // namespace touchtrace
