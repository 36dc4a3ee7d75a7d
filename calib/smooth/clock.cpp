#include "calib/smooth/clock.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "engine/base/error.h"
#include "engine/base/statistics.h"

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
    if (i > 0 && device_s[i] < device_s[i - 1])
      throw data_error(fmt::format("device time decreases at stamp {}: {} s after {} s", i,
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

/// Stamps in order of device time, each device time once.
struct Stamps {
  std::vector<double> device_s, host_s;

  void erase(std::size_t i) {
    device_s.erase(device_s.begin() + static_cast<std::ptrdiff_t>(i));
    host_s.erase(host_s.begin() + static_cast<std::ptrdiff_t>(i));
  }
};

/// Of repeated device times the earliest arrival.
Stamps unique_stamps(Times device_s, Times host_s) {
  Stamps stamps;
  for (std::size_t i = 0; i < device_s.size(); ++i)
    if (i > 0 && device_s[i] == stamps.device_s.back())
      stamps.host_s.back() = std::min(stamps.host_s.back(), host_s[i]);
    else
      stamps.device_s.push_back(device_s[i]), stamps.host_s.push_back(host_s[i]);
  return stamps;
}

/// Host minus device time, without the drift between the medians of the first and the last third.
std::vector<double> delays_without_drift(const Stamps& stamps) {
  const auto& device_s = stamps.device_s;
  const std::size_t count = device_s.size(), third = count / 3;
  std::vector<double> delays_s;
  for (std::size_t i = 0; i < count; ++i) delays_s.push_back(stamps.host_s[i] - device_s[i]);
  const auto first = delays_s.begin(), last = delays_s.end() - static_cast<std::ptrdiff_t>(third);
  const double drift = (median({last, delays_s.end()}) -
                        median({first, first + static_cast<std::ptrdiff_t>(third)})) /
                       (device_s[count - 1 - third / 2] - device_s[third / 2]);
  for (std::size_t i = 0; i < count; ++i) delays_s[i] -= drift * device_s[i];
  return delays_s;
}

/// Index of the earliest stamp, if it is early by comparison with the others.
std::optional<std::size_t> early_stamp(const Stamps& stamps) {
  constexpr double min_early_s = 0.002;
  auto delays_s = delays_without_drift(stamps);
  const auto earliest = std::ranges::min_element(delays_s);
  const auto index = static_cast<std::size_t>(earliest - delays_s.begin());
  const double first_s = *earliest;
  delays_s.erase(earliest);
  const double second_s = std::ranges::min(delays_s), gap_s = second_s - first_s;
  if (gap_s < min_early_s || gap_s < median(std::move(delays_s)) - second_s) return std::nullopt;
  return index;
}

Stamps without_early(Stamps stamps) {
  constexpr std::size_t stamps_per_early = 100;
  for (std::size_t i = 0; i < stamps.device_s.size() / stamps_per_early + 1; ++i) {
    if (stamps.device_s.size() < min_stamps_for_rate) break;
    const auto early = early_stamp(stamps);
    if (!early) break;
    stamps.erase(*early);
  }
  return stamps;
}

}  // namespace

ClockFit fit_clock(const std::vector<double>& device_time_s,
                   const std::vector<double>& host_time_s) {
  check(device_time_s, host_time_s);
  const auto stamps = without_early(unique_stamps(device_time_s, host_time_s));
  const Times device(stamps.device_s), host(stamps.host_s);
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
