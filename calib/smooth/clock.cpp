#include "calib/smooth/clock.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using Times = std::span<const double>;

constexpr std::size_t min_stamps_for_rate = 8;

void check(Times device_s, Times host_s) {
  if (device_s.empty() || device_s.size() != host_s.size())
    throw data_error(
        fmt::format("stream has {} device and {} host time stamps", device_s.size(), host_s.size()),
        "record it again");
  for (std::size_t i = 0; i < device_s.size(); ++i) {
    if (!std::isfinite(device_s[i]) || !std::isfinite(host_s[i]))
      throw data_error(fmt::format("time stamp {} is not finite", i),
                       "run: touchtrace check RECORDING");
    if (i > 0 && !(device_s[i] > device_s[i - 1]))
      throw data_error(fmt::format("device time does not increase at stamp {}: {} s after {} s", i,
                                   device_s[i], device_s[i - 1]),
                       "run: touchtrace check RECORDING");
  }
}

double mean(Times values) {
  double sum = 0.0;
  for (double value : values) sum += value - values.front();
  return values.front() + sum / static_cast<double>(values.size());
}

/// Indices of the lower convex hull (Andrew's monotone chain).
std::vector<std::size_t> lower_hull(Times x, Times y) {
  std::vector<std::size_t> hull;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto turns_right = [&] {
      const auto a = hull[hull.size() - 2], b = hull.back();
      return (x[b] - x[a]) * (y[i] - y[a]) - (y[b] - y[a]) * (x[i] - x[a]) <= 0.0;
    };
    while (hull.size() >= 2 && turns_right()) hull.pop_back();
    hull.push_back(i);
  }
  return hull;
}

/// Line through the hull edge below the mean device time. No other line below all stamps has a
/// smaller mean distance.
ClockFit fit_lower_line(Times device_s, Times host_s) {
  const auto hull = lower_hull(device_s, host_s);
  const double mean_device_s = mean(device_s);
  std::size_t edge = 0;
  while (edge + 2 < hull.size() && device_s[hull[edge + 1]] < mean_device_s) ++edge;
  const auto a = hull[edge];
  ClockFit fit;
  if (device_s.size() >= min_stamps_for_rate) {
    const auto b = hull[edge + 1];
    fit.rate = (host_s[b] - host_s[a]) / (device_s[b] - device_s[a]);
  }
  fit.offset_s = host_s[a] - fit.rate * device_s[a];
  if (device_s.size() < min_stamps_for_rate)
    for (std::size_t i = 0; i < device_s.size(); ++i)
      fit.offset_s = std::min(fit.offset_s, host_s[i] - device_s[i]);
  fit.mean_delay_s = mean(host_s) - fit.host_time_s(mean_device_s);
  return fit;
}

}  // namespace

ClockFit fit_clock(const std::vector<double>& device_time_s,
                   const std::vector<double>& host_time_s) {
  check(device_time_s, host_time_s);
  const Times device(device_time_s), host(host_time_s);
  auto fit = fit_lower_line(device, host);
  const auto half = device.size() / 2;
  if (half < min_stamps_for_rate) return fit;
  const auto first = fit_lower_line(device.first(half), host.first(half));
  const auto second = fit_lower_line(device.subspan(half), host.subspan(half));
  // the standard deviation of a half's rate is at least 2 sqrt(2) times the whole's
  fit.rate_sigma = std::abs(first.rate - second.rate) / std::sqrt(2.0) / std::sqrt(8.0);
  return fit;
}

}  // namespace touchtrace
