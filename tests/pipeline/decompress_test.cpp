#include "pipeline/acquire/import/bags/decompress.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <string>

#include "tests/support/compress.h"

namespace touchtrace {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string zstd(const std::string& bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), 3));
  return frame;
}

/// A covered camera sends images of zeros.
TEST(Decompress, AcceptsLargeImagesOfZeros) {
  const std::string zeros(8 << 20, '\0');
  for (const auto& [compression, text] : {std::pair{Compression::lz4, testing::lz4(zeros)},
                                          {Compression::bz2, testing::bz2(zeros)},
                                          {Compression::zstd, zstd(zeros)}}) {
    const Bytes stored(text.begin(), text.end());
    EXPECT_EQ(decompress(compression, stored, zeros.size()), Bytes(zeros.size()));
    EXPECT_THROW(decompress(compression, stored, zeros.size() - 1), std::exception);
    EXPECT_THROW(decompress(compression, stored, zeros.size() + 1), std::exception);
    EXPECT_THROW(decompress(compression, stored, std::size_t{1} << 40), std::exception);
  }
}

}  // namespace
}  // namespace touchtrace
