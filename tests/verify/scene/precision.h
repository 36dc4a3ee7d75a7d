#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// Error over run time: position of the object after 1 s of a stiff grip, an impact and a catch,
/// against a step 100 times smaller than the default.
void verify_precision(const std::function<void(Figure)>& emit);

/// Energy, forces and speeds over a grid of masses, stiffnesses, friction coefficients and steps.
void verify_extremes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
