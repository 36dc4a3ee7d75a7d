#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace {

// Groups of rows of `touchtrace-verify engine`, each in the file of its name.

/// Time from the start of a process to its first training step, with and without cached programs.
void verify_processes(const std::function<void(Figure)>& emit);
/// Tactile encoder: time of a step and fractions of the multiply-add peak.
void verify_encoder(const std::function<void(Figure)>& emit);
/// Whole model: time of a step.
void verify_training(const std::function<void(Figure)>& emit);
/// Extreme inputs and sizes; slowdown by subnormal numbers.
void verify_extremes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
