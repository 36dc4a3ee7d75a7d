#pragma once

#include <vector>

namespace touchtrace {

/// The middle value; of an even number the upper of the two. NaN if there is none.
double median(std::vector<double> values);

/// Standard deviation of normal data about zero from the median of |value|: outliers do not count.
double robust_sigma(std::vector<double> values);

}  // namespace touchtrace
