#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace touchtrace::h5 {

/// HDF5 filters of a chunk, in the order in which they are applied: shuffle, deflate, fletcher32.
/// Implemented here instead of with the library's filters: libdeflate takes a third of zlib's time
/// and runs outside the library's lock, and a damaged chunk can neither overrun a buffer nor
/// inflate without bound.
struct ChunkFilters {
  std::size_t shuffle_bytes = 1;  ///< bytes of a shuffled element; 1: not shuffled
  bool deflate = true;
  bool fletcher32 = true;
};

/// Fletcher-32 checksum as HDF5 computes it.
std::uint32_t fletcher32(std::span<const std::uint8_t> bytes);

/// Returns `raw` with all filters applied.
std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw,
                                       const ChunkFilters& filters);

/// Decodes `stored` into `raw`. Returns the fault of a damaged chunk, such as a wrong checksum.
std::optional<std::string> decode_chunk(std::span<const std::uint8_t> stored,
                                        const ChunkFilters& filters, std::span<std::uint8_t> raw);

}  // namespace touchtrace::h5
