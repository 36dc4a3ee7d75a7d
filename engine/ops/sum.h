#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// total[0] = the sum of `values`, in their order.
Launch sum(Runtime& runtime, const Buffer<float>& values, const Buffer<float>& total);

}  // namespace touchtrace
