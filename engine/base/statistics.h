#pragma once

#include <vector>

namespace touchtrace {

/// Median; the upper of the two middle values if their number is even, NaN if there are none.
double median(std::vector<double> values);

/// Value below which the fraction `probability` of the sorted values lies, without interpolation.
/// NaN if there are none.
double quantile(std::vector<double> values, double probability);

/// Robust estimate of the standard deviation of normal data with mean zero, from the median of
/// |value|. NaN if there are none.
double robust_sigma(std::vector<double> values);

/// Quantile of the standard normal distribution, 0 < probability < 1.
double normal_quantile(double probability);

}  // namespace touchtrace
