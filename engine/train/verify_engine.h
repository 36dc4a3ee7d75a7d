#pragma once

#include "engine/base/figure.h"

namespace touchtrace {

/// The rows of `touchtrace verify engine`: every group below, on the device chosen by default.
Verification verify_engine();

// The groups, each from the verify_*.cpp of its own name.

/// Worst errors of every operation at every shape of the table, on every device.
void verify_operations(const std::function<void(Figure)>& emit);
/// The contrastive loss where float is weak.
void verify_contrast(const std::function<void(Figure)>& emit);
/// The tactile encoder: seconds of a step, and shares of the multiply-add peak.
void verify_encoder(const std::function<void(Figure)>& emit);
/// The whole model: gradient against double, seconds to the first step, and of a step.
void verify_training(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
