#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Sets total[0] to the sum of `values`, added in order.
Launch sum(Runtime& runtime, const Buffer<float>& values, const Buffer<float>& total);

}  // namespace touchtrace
