#include "pipeline/acquire/import/bags/decompress.h"

#include <bzlib.h>
#include <fmt/core.h>
#include <lz4frame.h>
#include <zstd.h>

#include <map>
#include <memory>
#include <stdexcept>

namespace touchtrace {
namespace {

constexpr unsigned long long max_message_bytes = 256u << 20;
constexpr std::size_t max_size_bytes = 1u << 30;

/// Upper bound of a format's compression ratio. LZ4 adds 255 bytes per byte of a length; a zstd
/// block of 4 bytes holds 128 KiB; a bz2 block of 34 bytes holds 46 MB of one value (measured).
std::size_t max_ratio(Compression compression) {
  if (compression == Compression::lz4) return 255;
  return compression == Compression::zstd ? 40'000 : 1'500'000;
}

/// Returns the number of bytes written to `to`.
std::size_t decompress_lz4(ByteSpan stored, std::vector<std::uint8_t>& to) {
  LZ4F_dctx* created = nullptr;
  LZ4F_createDecompressionContext(&created, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      created, LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (true) {
    std::size_t in = stored.size() - read, out = to.size() - written;
    const auto left = LZ4F_decompress(context.get(), to.data() + written, &out,
                                      stored.data() + read, &in, nullptr);
    if (LZ4F_isError(left)) throw std::runtime_error(LZ4F_getErrorName(left));
    read += in, written += out;
    if (left == 0) return written;
    if (in == 0 && out == 0) throw std::runtime_error("LZ4 data end early or are too long");
  }
}

std::size_t decompress_bz2(ByteSpan stored, std::vector<std::uint8_t>& to) {
  // bzlib does not change the input
  auto* const from = const_cast<char*>(reinterpret_cast<const char*>(stored.data()));
  auto size = static_cast<unsigned>(to.size());
  if (BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to.data()), &size, from,
                                 static_cast<unsigned>(stored.size()), 0, 0) != BZ_OK)
    throw std::runtime_error("bz2 data are damaged");
  return size;
}

std::size_t decompress_zstd(ByteSpan stored, std::vector<std::uint8_t>& to) {
  const auto size = ZSTD_decompress(to.data(), to.size(), stored.data(), stored.size());
  if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));
  return size;
}

std::size_t decompress_to(Compression compression, ByteSpan stored, std::vector<std::uint8_t>& to) {
  if (compression == Compression::lz4) return decompress_lz4(stored, to);
  return compression == Compression::bz2 ? decompress_bz2(stored, to) : decompress_zstd(stored, to);
}

}  // namespace

std::optional<Compression> find_compression(const std::string& name) {
  static const std::map<std::string, Compression> all{{"", Compression::none},
                                                      {"none", Compression::none},
                                                      {"lz4", Compression::lz4},
                                                      {"bz2", Compression::bz2},
                                                      {"zstd", Compression::zstd}};
  const auto found = all.find(name);
  return found == all.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::uint8_t> decompress(Compression compression, ByteSpan stored, std::size_t size) {
  if (compression == Compression::none) return {stored.begin(), stored.end()};
  if (size > max_size_bytes || size / max_ratio(compression) > stored.size())
    throw std::runtime_error(
        fmt::format("{} compressed bytes claim to hold {}", stored.size(), size));
  std::vector<std::uint8_t> bytes(size);
  if (decompress_to(compression, stored, bytes) != size)
    throw std::runtime_error("compressed data state a wrong size");
  return bytes;
}

ByteSpan plain_message(ByteSpan stored, std::vector<std::uint8_t>& buffer) {
  const auto size = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (size == ZSTD_CONTENTSIZE_ERROR) return stored;  // not a frame
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size > max_message_bytes)
    throw std::runtime_error("a compressed message states no size, or one that is too large");
  buffer = decompress(Compression::zstd, stored, size);
  return buffer;
}

}  // namespace touchtrace
