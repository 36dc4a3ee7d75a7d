#include "pipeline/recording/chunk_codec.h"

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>

namespace touchtrace::h5 {
namespace {

constexpr int deflate_level = 1;
constexpr std::size_t checksum_bytes = 4;

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;
using Decompressor =
    std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

libdeflate_compressor* compressor() {
  thread_local const Compressor instance(libdeflate_alloc_compressor(deflate_level),
                                         &libdeflate_free_compressor);
  if (!instance) throw std::bad_alloc();
  return instance.get();
}

libdeflate_decompressor* decompressor() {
  thread_local const Decompressor instance(libdeflate_alloc_decompressor(),
                                           &libdeflate_free_decompressor);
  if (!instance) throw std::bad_alloc();
  return instance.get();
}

std::vector<std::uint8_t> shuffle(std::span<const std::uint8_t> raw, std::size_t element) {
  std::vector<std::uint8_t> planes(raw.size());
  const std::size_t count = raw.size() / element;
  for (std::size_t byte = 0; byte < element; ++byte)
    for (std::size_t i = 0; i < count; ++i) planes[byte * count + i] = raw[i * element + byte];
  return planes;
}

void unshuffle(std::span<const std::uint8_t> planes, std::size_t element,
               std::span<std::uint8_t> raw) {
  const std::size_t count = raw.size() / element;
  if (element == sizeof(std::uint16_t))  // depth images: one pass
    for (std::size_t i = 0; i < count; ++i)
      raw[2 * i] = planes[i], raw[2 * i + 1] = planes[count + i];
  else
    for (std::size_t byte = 0; byte < element; ++byte)
      for (std::size_t i = 0; i < count; ++i) raw[i * element + byte] = planes[byte * count + i];
}

void append_checksum(std::vector<std::uint8_t>& bytes) {
  const std::uint32_t sum = fletcher32(bytes);
  for (std::size_t i = 0; i < checksum_bytes; ++i)
    bytes.push_back(static_cast<std::uint8_t>(sum >> (8 * i)));
}

bool has_valid_checksum(std::span<const std::uint8_t> stored) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < checksum_bytes; ++i)
    sum |= std::uint32_t{stored[stored.size() - checksum_bytes + i]} << (8 * i);
  return sum == fletcher32(stored.first(stored.size() - checksum_bytes));
}

std::vector<std::uint8_t> deflate(std::span<const std::uint8_t> raw) {
  std::vector<std::uint8_t> packed(libdeflate_zlib_compress_bound(compressor(), raw.size()));
  packed.resize(
      libdeflate_zlib_compress(compressor(), raw.data(), raw.size(), packed.data(), packed.size()));
  return packed;
}

/// False unless exactly `raw.size()` bytes result.
bool inflate(std::span<const std::uint8_t> packed, std::span<std::uint8_t> raw) {
  return libdeflate_zlib_decompress(decompressor(), packed.data(), packed.size(), raw.data(),
                                    raw.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

}  // namespace

std::uint32_t fletcher32(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t words_between_folds = 360;
  std::uint32_t low = 0, high = 0;
  const auto add = [&](std::uint32_t word) { high += low += word; };
  const auto fold = [&] {
    low = (low & 0xffff) + (low >> 16);
    high = (high & 0xffff) + (high >> 16);
  };
  const std::size_t words = bytes.size() / 2;
  for (std::size_t word = 0; word < words;) {
    const std::size_t end = std::min(words, word + words_between_folds);
    for (; word < end; ++word) add(std::uint32_t{bytes[2 * word]} << 8 | bytes[2 * word + 1]);
    fold();
  }
  if (bytes.size() % 2 != 0) {
    add(std::uint32_t{bytes.back()} << 8);
    fold();
  }
  fold();
  return high << 16 | low;
}

std::vector<std::uint8_t> encode_chunk(std::span<const std::uint8_t> raw,
                                       const ChunkFilters& filters) {
  std::vector<std::uint8_t> bytes;
  if (filters.shuffle_bytes > 1) {
    bytes = shuffle(raw, filters.shuffle_bytes);
    raw = bytes;
  }
  auto stored = filters.deflate ? deflate(raw) : std::vector<std::uint8_t>(raw.begin(), raw.end());
  if (filters.fletcher32) append_checksum(stored);
  return stored;
}

std::optional<std::string> decode_chunk(std::span<const std::uint8_t> stored,
                                        const ChunkFilters& filters, std::span<std::uint8_t> raw) {
  if (filters.fletcher32) {
    if (stored.size() < checksum_bytes || !has_valid_checksum(stored)) return "wrong checksum";
    stored = stored.first(stored.size() - checksum_bytes);
  }
  thread_local std::vector<std::uint8_t> planes;
  planes.resize(filters.shuffle_bytes > 1 ? raw.size() : 0);
  const std::span<std::uint8_t> target = planes.empty() ? raw : planes;
  if (filters.deflate) {
    if (!inflate(stored, target)) return "cannot be decompressed";
  } else {
    if (stored.size() != target.size()) return "wrong size";
    std::copy(stored.begin(), stored.end(), target.begin());
  }
  if (!planes.empty()) unshuffle(planes, filters.shuffle_bytes, raw);
  return std::nullopt;
}

}  // namespace touchtrace::h5
