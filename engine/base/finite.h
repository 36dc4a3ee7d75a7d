#pragma once

#include <algorithm>
#include <cmath>
#include <ranges>

namespace touchtrace {

/// Whether a range of numbers has neither NaN nor infinities.
template <std::ranges::input_range Numbers>
bool all_finite(const Numbers& numbers) {
  return std::ranges::all_of(numbers, [](auto number) { return std::isfinite(number); });
}

}  // namespace touchtrace
