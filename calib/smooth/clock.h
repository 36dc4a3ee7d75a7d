#pragma once

#include <vector>

namespace touchtrace {

/// A device's clock against the host's: host = offset_s + rate * device. The line runs below all
/// arrival stamps, where latency is least, so the least latency stays in `offset_s`: stamps alone
/// cannot show it.
struct ClockFit {
  double offset_s = 0.0, rate = 1.0;
  double mean_delay_s = 0.0;    ///< of the stamps above the line
  double rate_deviation = 0.0;  ///< of `rate`, from the two halves of the stamps

  double host_time_s(double device_time_s) const { return offset_s + rate * device_time_s; }
  double drift_ppm() const { return 1e6 * (rate - 1.0); }
};

/// The line below all (device, host) stamps with the least mean distance: an edge of their lower
/// convex hull, found exactly in O(n). `device_time_s` must increase. Fewer than 8 stamps give an
/// offset, at rate 1.
/// Throws data_error for no stamps, for stamps that are not finite and for device times that do not
/// increase.
ClockFit fit_clock(const std::vector<double>& device_time_s,
                   const std::vector<double>& host_time_s);

}  // namespace touchtrace
