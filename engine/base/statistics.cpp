#include "engine/base/statistics.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace touchtrace {

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace touchtrace
