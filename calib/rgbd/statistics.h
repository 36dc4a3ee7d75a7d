#pragma once

#include <vector>

#include "engine/base/statistics.h"

namespace touchtrace {

/// Standard deviation of normal data about zero from the median of |value|: outliers do not count.
double robust_sigma(std::vector<double> values);

}  // namespace touchtrace
