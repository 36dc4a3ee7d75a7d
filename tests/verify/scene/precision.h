#pragma once

#include "tests/verify/support/figure.h"

namespace touchtrace::scene {

/// Error against run time: where the object is after 1 s of a stiff grip, an impact and a catch,
/// against a step 100 times smaller than the activities' one.
void verify_precision(const std::function<void(Figure)>& emit);

/// Light and heavy, soft and stiff, slippery and rough, slow and quick, with fine and coarse steps.
void verify_extremes(const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
