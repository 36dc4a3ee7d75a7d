#include "engine/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace touchtrace {

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double robust_sigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  constexpr double median_of_abs_normal = 0.6744897501960817;
  return median(std::move(values)) / median_of_abs_normal;
}

}  // namespace touchtrace
