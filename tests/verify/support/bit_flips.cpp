#include "tests/verify/support/bit_flips.h"

#include <fstream>

#include "engine/base/error.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

void flip_bit(const std::filesystem::path& file, std::uint64_t bit) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekg(static_cast<std::streamoff>(bit / 8));
  const auto byte = static_cast<char>(stream.get() ^ (1 << (bit % 8)));
  stream.seekp(static_cast<std::streamoff>(bit / 8));
  stream.put(byte);
}

}  // namespace

BitFlips flip_bits(const std::filesystem::path& file, int flips,
                   const std::function<std::string()>& content) {
  const std::string expected = content();
  const std::uint64_t bits = 8 * std::filesystem::file_size(file);
  RandomStream random(1, "bit flips");
  BitFlips counts;
  for (int i = 0; i < flips; ++i) {
    const std::uint64_t bit = random.below(bits);
    flip_bit(file, bit);
    try {
      counts.silent += content() != expected;
    } catch (const Error&) {
      ++counts.detected;
    }
    flip_bit(file, bit);
  }
  return counts;
}

}  // namespace touchtrace
