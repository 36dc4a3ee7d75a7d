#pragma once

#include "engine/base/figure.h"

namespace touchtrace {

/// What smoothing and clocks promise, on synthetic tracks: errors against central differences and
/// Savitzky-Golay, intervals, units, speed.
void measure_smoothing(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
