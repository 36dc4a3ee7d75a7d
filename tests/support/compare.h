#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace touchtrace::testing {

/// Compares arrays: |a - r| <= atol + k eps sqrt(n) scale for every element, with eps of `T`, n the
/// number of terms summed in each value, and scale the largest |r|. NaN never passes. Used by all
/// tests.
template <class T>
::testing::AssertionResult close(std::span<const T> actual, std::span<const double> reference,
                                 double k, double n, double atol = 0.0) {
  if (actual.size() != reference.size())
    return ::testing::AssertionFailure()
           << actual.size() << " values instead of " << reference.size();
  double scale = 0.0;
  for (double r : reference) scale = std::max(scale, std::abs(r));
  const double bound =
      atol + k * static_cast<double>(std::numeric_limits<T>::epsilon()) * std::sqrt(n) * scale;
  std::size_t worst = 0, bad = 0;
  double worst_error = -1.0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double error = std::abs(static_cast<double>(actual[i]) - reference[i]);
    if (!(error <= bound)) ++bad;
    if (!(error <= worst_error)) worst_error = error, worst = i;
  }
  if (bad == 0) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << bad << " of " << actual.size() << " values differ by more than " << bound
         << "; worst at " << worst << ": " << actual[worst] << " instead of " << reference[worst];
}

}  // namespace touchtrace::testing
