#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// L1 + pinball(Q) + pinball(1 - Q) of a roll-out (equation 4) and its gradient; Q is
/// `band_quantile`.
struct StateLossArrays {
  int sequences, steps, state;
  float band_quantile;                    ///< between 0 and a half
  Buffer<float> states;                   ///< [T + 1, S, 16]; those from S on are compared
  Buffer<float> spread, target;           ///< [T, S, 16]
  Buffer<float> weight;                   ///< [T, S], the mean's divisor included
  Buffer<float> row_loss;                 ///< [T, S], weighted
  Buffer<float> grad_state, grad_spread;  ///< [T, S, 16]
};

Launch state_loss(Runtime& runtime, const StateLossArrays& arrays);

}  // namespace touchtrace
