#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verify/calib/monte_carlo.h"

namespace touchtrace::testing {

/// NEES is a mean of `runs` draws of chi^2 over its n degrees of freedom: its standard deviation is
/// sqrt(2 / (n runs)); the bound is 4 of these.
inline void expect_consistent(double nees, int parameters, int runs) {
  EXPECT_NEAR(nees, 1.0, 4.0 * std::sqrt(2.0 / (parameters * runs)));
}

/// The standard deviation of an RMSE from `runs` draws is 1 / sqrt(2 runs) of it; the bound is 4 of
/// these.
inline void expect_efficient(const MonteCarlo& result) {
  for (std::size_t i = 0; i < result.names.size(); ++i)
    EXPECT_NEAR(result.rmse_ratio[i], 1.0, 4.0 / std::sqrt(2.0 * result.runs)) << result.names[i];
}

/// Compares each error with its own standard deviation. For 8 to 22 normal errors, 4.5 is exceeded
/// with a probability below 2e-4.
inline void expect_within_own_sigma(const RgbdCalibration& c, const RgbdParameters& truth) {
  const Eigen::VectorXd error = errors(c, truth);
  for (Eigen::Index i = 0; i < error.size(); ++i)
    EXPECT_LT(std::abs(error[i]), 4.5 * std::sqrt(c.covariance(i, i)))
        << c.parameters[static_cast<std::size_t>(i)];
}

}  // namespace touchtrace::testing
