#pragma once

#include <vector>

namespace touchtrace {

/// Median; the upper of the two middle values if their number is even, NaN if there are none.
double median(std::vector<double> values);

}  // namespace touchtrace
