#include "engine/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace touchtrace {

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double quantile(std::vector<double> values, double probability) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(probability * last);
  std::ranges::nth_element(values, at);
  return *at;
}

double robust_sigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  constexpr double median_of_abs_normal = 0.6744897501960817;
  return median(std::move(values)) / median_of_abs_normal;
}

double normal_quantile(double probability) {
  double low = -40.0, high = 40.0;  // beyond, the probability is not a positive double
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::numbers::sqrt2) < probability ? low : high) = middle;
  }
  return low;
}

}  // namespace touchtrace
