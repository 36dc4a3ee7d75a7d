#pragma once

#include "engine/cl/launch.h"
#include "engine/ops/activation.h"
#include "engine/ops/dense.h"

namespace touchtrace {

/// Floats per state in device memory, zero-padded.
inline constexpr int state_lanes = 16;

/// Work-items of a work-group of the roll-outs' GPU variants (kernels/rollout_gpu.clh).
inline constexpr std::size_t gpu_rollout_group = 256;

/// Whether a roll-out uses its GPU variant: local memory then also has to hold `hidden_values`
/// values of each of four sequences.
bool uses_gpu_rollout(const Runtime& runtime, int hidden_values);

/// Arrays of a roll-out of the dynamics MLP over S sequences and T steps (kernels/rollout.cl). Rows
/// are ordered [T][S]. `hidden` is a multiple of 64, `state` at most 16.
struct RolloutArrays {
  int sequences, steps, state, hidden;
  Activation activation;
  Buffer<float> parameters;
  int b2_at, w2_at, w3_at;      ///< offsets: [hidden], [hidden, hidden], [2 state, hidden]
  Buffer<float> w1, w2;         ///< transposed: [state, hidden], [hidden, hidden]
  Buffer<float> w3, b3;         ///< transposed and padded: [hidden, 2, 16], [2, 16]
  MatrixView input_projection;  ///< [T * S, hidden]; row stride 0: shared
  Buffer<float> states;         ///< [T + 1, S, 16]; the first S rows are the initial states
  Buffer<float> h1, h2;         ///< [T, S, hidden]
  Buffer<float> pre_activation1, pre_activation2;  ///< [T, S, hidden], if slope_from_sum()
  Buffer<float> spread;                            ///< [T, S, 16]
};

struct RolloutGradients {
  Buffer<float> grad_state, grad_spread;  ///< [T, S, 16], of the loss
  Buffer<float> w1;                       ///< [hidden, 16], padded
  Buffer<float> d_out;                    ///< [T, S, 2, 16], with respect to delta and band
  Buffer<float> d_h1, d_h2;               ///< [T, S, hidden], with respect to pre-activations
};

Launch rollout(Runtime& runtime, const RolloutArrays& arrays);
Launch rollout_backward(Runtime& runtime, const RolloutArrays& arrays,
                        const RolloutGradients& gradients);

}  // namespace touchtrace
