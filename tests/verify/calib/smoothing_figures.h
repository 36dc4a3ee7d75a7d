#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Measures smoothing and clock fits on synthetic tracks: errors compared with Savitzky-Golay and a
/// smoother with constant jerk density, calibration of intervals, speed.
void measure_smoothing(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
