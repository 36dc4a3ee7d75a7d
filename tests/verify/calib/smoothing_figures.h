#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Measures smoothing and clock fits on synthetic tracks: errors compared with Savitzky-Golay and a
/// smoother with constant jerk density, calibration of intervals, stiff and extreme cases, speed.
void measure_smoothing(const std::function<void(Figure)>& emit);

/// Measures only the stiff and extreme cases: results are right or come with an error status, and
/// do not depend on units.
void measure_extremes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
