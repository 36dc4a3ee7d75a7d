#pragma once

#include "engine/check/info_nce_reference.h"
#include "engine/cl/runtime.h"

namespace touchtrace {

/// Result of the kernels.
InfoNceResult info_nce_on_device(Runtime& runtime, const InfoNceProblem& problem);

}  // namespace touchtrace
