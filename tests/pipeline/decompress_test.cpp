#include "pipeline/acquire/import/bags/decompress.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

#include <string>

namespace touchtrace {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes lz4(const Bytes& bytes) {
  Bytes frame(LZ4F_compressFrameBound(bytes.size(), nullptr));
  frame.resize(LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), nullptr));
  return frame;
}

Bytes bz2(Bytes bytes) {
  Bytes compressed(bytes.size() / 64 + 600);
  auto size = static_cast<unsigned>(compressed.size());
  BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(compressed.data()), &size,
                           reinterpret_cast<char*>(bytes.data()),
                           static_cast<unsigned>(bytes.size()), 9, 0, 0);
  compressed.resize(size);
  return compressed;
}

Bytes zstd(const Bytes& bytes) {
  Bytes frame(ZSTD_compressBound(bytes.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), 3));
  return frame;
}

/// A covered camera sends images of zeros.
TEST(Decompress, AcceptsLargeImagesOfZeros) {
  const Bytes zeros(8 << 20);
  for (const auto& [compression, stored] : {std::pair{Compression::lz4, lz4(zeros)},
                                            {Compression::bz2, bz2(zeros)},
                                            {Compression::zstd, zstd(zeros)}}) {
    EXPECT_EQ(decompress(compression, stored, zeros.size()), zeros);
    EXPECT_THROW(decompress(compression, stored, zeros.size() - 1), std::exception);
    EXPECT_THROW(decompress(compression, stored, zeros.size() + 1), std::exception);
    EXPECT_THROW(decompress(compression, stored, std::size_t{1} << 40), std::exception);
  }
}

}  // namespace
}  // namespace touchtrace
