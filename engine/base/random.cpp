#include "engine/base/random.h"

#include <cmath>
#include <numbers>

namespace touchtrace {
namespace {

constexpr std::uint32_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
constexpr int rounds = 10;

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (unsigned char c : text) hash = (hash ^ c) * 0x100000001B3u;
  return hash;
}

double to_unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (std::uint64_t{high} << 32 | low) >> 11;
  return static_cast<double>(bits) * 0x1p-53;
}

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> x,
                                        std::array<std::uint32_t, 2> key) noexcept {
  auto [k0, k1] = key;
  for (int round = 0; round < rounds; ++round, k0 += weyl_0, k1 += weyl_1) {
    const std::uint64_t p0 = std::uint64_t{multiplier_0} * x[0];
    const std::uint64_t p1 = std::uint64_t{multiplier_1} * x[2];
    x = {static_cast<std::uint32_t>(p1 >> 32) ^ x[1] ^ k0, static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ x[3] ^ k1, static_cast<std::uint32_t>(p0)};
  }
  return x;
}

RandomStream::RandomStream(std::uint64_t seed, std::string_view name)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      name_hash_(fnv1a(name)) {}

std::array<std::uint32_t, 4> RandomStream::block(std::uint64_t index) const noexcept {
  return philox4x32(
      {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
       static_cast<std::uint32_t>(name_hash_), static_cast<std::uint32_t>(name_hash_ >> 32)},
      key_);
}

double RandomStream::uniform_at(std::uint64_t index) const noexcept {
  const auto x = block(index);
  return to_unit(x[0], x[1]);
}

double RandomStream::normal_at(std::uint64_t index) const noexcept {
  const auto x = block(index);
  const double radius = std::sqrt(-2.0 * std::log1p(-to_unit(x[0], x[1])));
  return radius * std::cos(2.0 * std::numbers::pi * to_unit(x[2], x[3]));
}

std::uint64_t RandomStream::below(std::uint64_t bound) noexcept {
  const std::uint64_t rejected = (0 - bound) % bound;
  for (;;) {
    const auto x = block(position_++);
    const std::uint64_t bits = std::uint64_t{x[0]} << 32 | x[1];
    if (bits >= rejected) return bits % bound;
  }
}

}  // namespace touchtrace
