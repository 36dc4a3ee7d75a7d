#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// The rows of `touchtrace-verify engine`: every group below, on the device chosen by default.
Verification verify_engine();

// The groups, each from the verify_*.cpp of its own name.

/// Worst errors of every operation at every shape of the table, on every device.
void verify_operations(const std::function<void(Figure)>& emit);
/// The contrastive loss where float is weak.
void verify_contrast(const std::function<void(Figure)>& emit);
/// The tactile encoder: seconds of a step, and shares of the multiply-add peak.
void verify_encoder(const std::function<void(Figure)>& emit);
/// The whole model: gradient against double, and seconds of a step.
void verify_training(const std::function<void(Figure)>& emit);
/// Inputs and sizes at which something could go wrong; what subnormal numbers cost.
void verify_extremes(const std::function<void(Figure)>& emit);
/// The same bits from the same seed, and when stopped and resumed.
void verify_bits(const std::function<void(Figure)>& emit);

// Areas of their own, of one row each, for figures that need a process of their own.

/// One update of the default model: its loss.
Verification verify_first_step();
/// A short training run: a hash of its weights.
Verification verify_weights();

}  // namespace touchtrace
