#pragma once

#include <cstdint>

#include "engine/check/info_nce_reference.h"
#include "engine/cl/runtime.h"

namespace touchtrace {

/// Result of the kernels.
InfoNceResult info_nce_on_device(Runtime& runtime, const InfoNceProblem& problem);

/// Largest relative error of the anchors' losses, not counting underflow near float's smallest
/// normal number. Infinite if a value is not finite.
double info_nce_error(Runtime& runtime, const InfoNceProblem& problem);

/// Sixteen embeddings of 64 values of four objects, with logits up to `logit`. `alike`: logits
/// differ by some tens only, so that a loss is a small difference of large numbers. `unit`:
/// embeddings have random lengths, and the temperature sets the logits.
InfoNceProblem info_nce_extreme(double logit, bool alike, bool unit, std::uint64_t seed);

}  // namespace touchtrace
