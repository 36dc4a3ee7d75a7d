#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Rows of `touchtrace-verify engine`: all groups below, on the default device.
Verification verify_engine();

// Groups, each in the verify_*.cpp of the same name.

/// Largest error of each operation over the shapes of the table, on every device.
void verify_operations(const std::function<void(Figure)>& emit);
/// Contrastive loss with large logits and with nearly equal ones, where float loses accuracy.
void verify_contrast(const std::function<void(Figure)>& emit);
/// Tactile encoder: time of a step and fractions of the multiply-add peak.
void verify_encoder(const std::function<void(Figure)>& emit);
/// Whole model: gradient against double, and time of a step.
void verify_training(const std::function<void(Figure)>& emit);
/// Extreme inputs and sizes; slowdown by subnormal numbers.
void verify_extremes(const std::function<void(Figure)>& emit);
/// Bitwise reproducibility, also of a resumed training.
void verify_bits(const std::function<void(Figure)>& emit);

// Areas of one row each, for figures that need a process of their own.

/// Loss of one update of the default model.
Verification verify_first_step();
/// Hash of the weights after a short training.
Verification verify_weights();

}  // namespace touchtrace
