#include "engine/base/statistics.h"

#include <cmath>
#include <utility>

namespace touchtrace {

double robust_sigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  constexpr double median_of_abs_normal = 0.6744897501960817;
  return median(std::move(values)) / median_of_abs_normal;
}

}  // namespace touchtrace
