#pragma once

#include "engine/base/figure.h"

namespace touchtrace {

/// Simulated boards, 1000 runs a level: NEES, RMSE over the Cramer-Rao bound, seconds.
void verify_simulated_calibration(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
