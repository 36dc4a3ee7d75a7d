#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// L1 + pinball(0.1) + pinball(0.9) of a roll-out (equation 4) and its gradient.
struct StateLossArrays {
  int sequences, steps, state;
  Buffer<float> states;                   ///< [T + 1, S, 16]; those from S on are compared
  Buffer<float> spread, target;           ///< [T, S, 16]
  Buffer<float> weight;                   ///< [T, S], the mean's divisor included
  Buffer<float> row_loss;                 ///< [T, S], weighted
  Buffer<float> grad_state, grad_spread;  ///< [T, S, 16]
};

Launch state_loss(Runtime& runtime, const StateLossArrays& arrays);

}  // namespace touchtrace
