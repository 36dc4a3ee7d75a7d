#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace touchtrace::h5 {

/// The filters of one stored chunk, in the order in which HDF5 applies them: shuffle, deflate,
/// fletcher32. Done here rather than inside the library: libdeflate takes a third of zlib's time,
/// runs outside the library's lock, and a damaged chunk can neither overrun nor inflate without
/// bound.
struct ChunkFilters {
  std::size_t shuffle_bytes = 1;  ///< size of the elements that were shuffled; 1: not shuffled
  bool deflate = true;
  bool fletcher32 = true;
};

/// HDF5's checksum of a chunk.
std::uint32_t fletcher32(std::span<const std::uint8_t> bytes);

/// `raw` as it is stored, all filters applied.
std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw,
                                       const ChunkFilters& filters);

/// Fills `raw` from `stored`. Returns what is wrong with the chunk, or nothing if it is sound.
std::optional<std::string> decode_chunk(std::span<const std::uint8_t> stored,
                                        const ChunkFilters& filters, std::span<std::uint8_t> raw);

}  // namespace touchtrace::h5
