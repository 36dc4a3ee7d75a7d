#pragma once

#include <concepts>

namespace touchtrace {

/// Smallest integer not below a / b, for a >= 0 and b > 0.
template <std::integral T>
constexpr T ceil_div(T a, T b) {
  return (a + b - 1) / b;
}

/// Smallest multiple of `unit` not below `value`, for value >= 0 and unit > 0.
template <std::integral T>
constexpr T round_up(T value, T unit) {
  return ceil_div(value, unit) * unit;
}

}  // namespace touchtrace
