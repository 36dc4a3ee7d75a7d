#include "calib/smooth/clock.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

struct Stamps {
  std::vector<double> device_s, host_s;
};

/// Stamps with exponential delays above `latency_s`; 3 % are lost.
Stamps stamps(double seconds, double rate_hz, double offset_s, double drift_ppm, double latency_s,
              double jitter_s, std::uint64_t seed) {
  RandomStream random(seed, "stamps");
  Stamps result;
  for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
    const double device_s = i / rate_hz,
                 delay_s = latency_s - jitter_s * std::log1p(-random.uniform());
    if (random.uniform() < 0.03) continue;
    result.device_s.push_back(device_s);
    result.host_s.push_back(offset_s + (1.0 + 1e-6 * drift_ppm) * device_s + delay_s);
  }
  return result;
}

TEST(Clock, EstimatesOffsetAndDriftUpToTheMinimumLatency) {
  double offset_squares = 0.0, drift_squares = 0.0;
  constexpr int runs = 40;
  for (int run = 0; run < runs; ++run) {
    const auto s = stamps(120.0, 15.0, 7.0, 40.0, 0.004, 0.003, static_cast<std::uint64_t>(run));
    const auto fit = fit_clock(s.device_s, s.host_s);
    offset_squares += std::pow(fit.host_time_s(60.0) - (7.0 + 60.0 * (1.0 + 40e-6) + 0.004), 2);
    drift_squares += std::pow(fit.drift_ppm() - 40.0, 2);
    EXPECT_NEAR(fit.mean_delay_s, 0.003, 0.0005);
  }
  EXPECT_LT(std::sqrt(offset_squares / runs), 0.5e-3);
  EXPECT_LT(std::sqrt(drift_squares / runs), 20.0);
}

TEST(Clock, LineIsBelowEveryStamp) {
  const auto s = stamps(30.0, 20.0, -3.0, -80.0, 0.0, 0.01, 9);
  const auto fit = fit_clock(s.device_s, s.host_s);
  for (std::size_t i = 0; i < s.device_s.size(); ++i)
    EXPECT_GE(s.host_s[i] - fit.host_time_s(s.device_s[i]), -1e-9);
}

TEST(Clock, FitsOnlyTheOffsetOfFewStamps) {
  const auto fit = fit_clock({1.0, 2.0}, {11.5, 12.1});
  EXPECT_EQ(fit.rate, 1.0);
  EXPECT_NEAR(fit.offset_s, 10.1, 1e-12);
}

TEST(Clock, IgnoresASingleEarlyStamp) {
  for (const std::size_t early : {0, 57, 199}) {
    std::vector<double> device_s, host_s;
    for (std::size_t i = 0; i < 200; ++i) {
      device_s.push_back(0.05 * static_cast<double>(i));
      host_s.push_back(10.0 + 1.00005 * device_s[i] + 0.001 * static_cast<double>(i * i % 7));
    }
    host_s[early] -= 0.02;
    const auto fit = fit_clock(device_s, host_s);
    EXPECT_NEAR(fit.offset_s, 10.0, 1e-4) << early;
    EXPECT_NEAR(fit.drift_ppm(), 50.0, 20.0) << early;
  }
}

TEST(Clock, AllowsRepeatedStamps) {
  const auto fit = fit_clock({1.0, 1.0, 2.0}, {11.7, 11.5, 12.6});
  EXPECT_NEAR(fit.offset_s, 10.5, 1e-12);
}

TEST(Clock, RejectsMissingDecreasingAndNonFiniteStamps) {
  EXPECT_THROW(fit_clock({}, {}), Error);
  EXPECT_THROW(fit_clock({1.0, 2.0}, {2.0}), Error);
  EXPECT_THROW(fit_clock({1.0, 0.5}, {2.0, 3.0}), Error);
  EXPECT_THROW(fit_clock({1.0, 2.0}, {2.0, NAN}), Error);
}

}  // namespace
}  // namespace touchtrace
