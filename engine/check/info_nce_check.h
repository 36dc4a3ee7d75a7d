#pragma once

#include <cstdint>

#include "engine/check/info_nce_reference.h"
#include "engine/cl/runtime.h"

namespace touchtrace {

/// info_nce_reference as the kernels compute it.
InfoNceResult info_nce_on_device(Runtime& runtime, const InfoNceProblem& problem);

/// The worst |kernel - reference| / reference of the anchors' losses; what float may lose of a
/// value near its smallest normal is not counted. Infinite for a NaN or an infinity.
double info_nce_error(Runtime& runtime, const InfoNceProblem& problem);

/// Sixteen embeddings of 64 values and four objects whose logits are as large as `logit`. `alike`:
/// they differ by some tens only, so that a loss is the small difference of large numbers. With
/// `unit` the embeddings' lengths are random, and the temperature makes the logits.
InfoNceProblem info_nce_extreme(double logit, bool alike, bool unit, std::uint64_t seed);

}  // namespace touchtrace
