#pragma once

#include <vector>

namespace touchtrace {

/// Affine map from a device's clock to the host's: host = offset_s + rate * device. The line
/// touches the arrival stamps from below, where latency is smallest, so `offset_s` includes the
/// minimum latency: stamps alone cannot separate the two.
struct ClockFit {
  double offset_s = 0.0, rate = 1.0;
  double mean_delay_s = 0.0;  ///< mean height of the stamps above the line
  double rate_sigma = 0.0;    ///< of `rate`, from the two halves of the stamps; 0 below 16 stamps

  double host_time_s(double device_time_s) const { return offset_s + rate * device_time_s; }
  double drift_ppm() const { return 1e6 * (rate - 1.0); }
};

/// Fits the line below all (device, host) stamps with the smallest mean distance: an edge of their
/// lower convex hull, exact, O(n). With fewer than 8 stamps only the offset is fitted, at rate 1.
/// Ignores up to 1 % of stamps that are early: farther below the others than the median is above
/// them, and by more than 2 ms. Repeated stamps are allowed.
/// Throws data_error if there are no stamps, if the lengths differ, if a stamp is not finite or if
/// `device_time_s` decreases.
ClockFit fit_clock(const std::vector<double>& device_time_s,
                   const std::vector<double>& host_time_s);

}  // namespace touchtrace
