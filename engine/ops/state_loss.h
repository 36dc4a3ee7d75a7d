#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// Arrays of the loss L1 + pinball(Q) + pinball(1 - Q) of a roll-out (equation 4) and its gradient,
/// with Q = band_quantile.
struct StateLossArrays {
  int sequences, steps, state;
  float band_quantile;                    ///< in (0, 0.5)
  Buffer<float> states;                   ///< [T + 1, S, 16]; rows from S on are predictions
  Buffer<float> spread, target;           ///< [T, S, 16]
  Buffer<float> weight;                   ///< [T, S], including the divisor of the mean
  Buffer<float> row_loss;                 ///< [T, S], weighted
  Buffer<float> grad_state, grad_spread;  ///< [T, S, 16]
};

Launch state_loss(Runtime& runtime, const StateLossArrays& arrays);

}  // namespace touchtrace
