#pragma once

#include <vector>

namespace touchtrace {

/// Spreads frames that share a stamp evenly over the time until the next stamp, or over the typical
/// interval of stamps before a pause. The first ones, which may have begun between two stamps, end
/// at the next stamp. Does nothing, and returns false, unless over 10 % of the frames share a
/// stamp. `time_s` [frames] does not decrease. Reports what it does.
bool spread_repeated_stamps(std::vector<double>& time_s);

/// Inverse of the mean interval of stamps that were spread, without pauses.
double rate_without_pauses_hz(const std::vector<double>& time_s);

}  // namespace touchtrace
