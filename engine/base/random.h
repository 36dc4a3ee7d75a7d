#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Philox 4x32-10 block function (Salmon et al., SC'11), as in Random123.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) noexcept;

/// Named stream of random numbers from the counter-based generator Philox 4x32-10.
///
/// Streams with different names or seeds are independent. Numbers can be drawn by index, so results
/// need not depend on the order of draws or the number of threads. Unlike the distributions of
/// <random>, results are the same on every platform.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  /// Four random words of block `index`.
  std::array<std::uint32_t, 4> block(std::uint64_t index) const noexcept;
  /// Standard normal number `index`.
  double normal_at(std::uint64_t index) const noexcept;
  /// Uniform number `index` in [0, 1).
  double uniform_at(std::uint64_t index) const noexcept;

  // Sequential draws, which advance position().
  double uniform() noexcept { return uniform_at(position_++); }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  double normal() noexcept { return normal_at(position_++); }
  double normal(double mean, double std) noexcept { return mean + std * normal(); }
  /// Unbiased uniform integer in [0, bound), bound > 0.
  std::uint64_t below(std::uint64_t bound) noexcept;

  std::uint64_t position() const noexcept { return position_; }
  void seek(std::uint64_t position) noexcept { position_ = position; }

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint64_t name_hash_;
  std::uint64_t position_ = 0;
};

/// `count` standard normal values, rounded to float precision.
template <class T = float>
std::vector<T> normal_floats(std::size_t count, RandomStream& random) {
  std::vector<T> values(count);
  for (T& value : values) value = static_cast<float>(random.normal());
  return values;
}

}  // namespace touchtrace
