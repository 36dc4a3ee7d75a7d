#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace touchtrace {

/// The block cipher behind the streams: Philox 4x32-10, as published with Random123.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) noexcept;

/// A named stream of random numbers: Philox 4x32-10 (Salmon et al., SC'11), counter-based.
///
/// Streams of different names or seeds are independent, and every number can be had by its index,
/// so results depend neither on the order of draws nor on the number of threads. The same on every
/// platform, unlike the distributions of <random>.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  /// The four words of block `index`; pure.
  std::array<std::uint32_t, 4> block(std::uint64_t index) const noexcept;
  /// Standard normal number `index`; pure.
  double normal_at(std::uint64_t index) const noexcept;
  /// Uniform number `index` in [0, 1); pure.
  double uniform_at(std::uint64_t index) const noexcept;

  /// The next number of the stream, and one step on.
  double uniform() noexcept { return uniform_at(position_++); }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  double normal() noexcept { return normal_at(position_++); }
  double normal(double mean, double deviation) noexcept { return mean + deviation * normal(); }
  /// Uniform integer in [0, bound), without bias; bound > 0.
  std::uint64_t below(std::uint64_t bound) noexcept;

  std::uint64_t position() const noexcept { return position_; }
  void seek(std::uint64_t position) noexcept { position_ = position; }

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint64_t name_hash_;
  std::uint64_t position_ = 0;
};

}  // namespace touchtrace
