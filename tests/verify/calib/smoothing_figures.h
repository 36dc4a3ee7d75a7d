#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// What smoothing and clocks promise, on synthetic tracks: errors against Savitzky-Golay and a
/// smoother with one jerk density, intervals, stiff and extreme cases, speed.
void measure_smoothing(const std::function<void(Figure)>& emit);

/// Of these the stiff and extreme cases: they end well or in a named refusal, and units do not
/// matter.
void measure_extremes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
