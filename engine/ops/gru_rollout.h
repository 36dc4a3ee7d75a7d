#pragma once

#include "engine/ops/rollout.h"

namespace touchtrace {

/// Row strides of the GRU's arrays, in floats (kernels/gru_rollout.cl).
constexpr int gru_gates_row(int hidden) { return 4 * hidden + 16; }
constexpr int gru_weights_row(int hidden) { return 3 * hidden + 16; }

/// Arrays of a GRU roll-out over S sequences and T steps (kernels/gru_rollout.cl). Rows are ordered
/// [T][S]. `hidden` is a multiple of 64, `state` at most 16. Gates in PyTorch's order: reset r,
/// update z, new n; then a, the hidden part of n that r scales.
struct GruArrays {
  int sequences, steps, state, hidden;
  Buffer<float> parameters;
  /// Offsets in `parameters`: bias_hh [3 hidden], weight_hh [3 hidden, hidden], [2 state, hidden].
  int bias_at, u_at, w3_at;
  /// Transposed state columns of weight_ih and transposed weight_hh: [state] and [hidden] rows of
  /// 3 hidden, gru_weights_row() apart.
  Buffer<float> w, u;
  Buffer<float> w3, b3;         ///< transposed and padded: [hidden, 2, 16], [2, 16]
  MatrixView input_projection;  ///< input projection [T * S, 3 hidden]; row stride 0: shared
  Buffer<float> states;         ///< [T + 1, S, 16]; the first S rows are the initial states
  Buffer<float> h;       ///< [T + 1, S, hidden]; the first S rows are the initial hidden states
  Buffer<float> gates;   ///< [T * S] rows of r, z, n, a, gru_gates_row() apart
  Buffer<float> spread;  ///< [T, S, 16]
};

struct GruGradients {
  Buffer<float> grad_state, grad_spread;  ///< [T, S, 16], of the loss
  Buffer<float> w;                        ///< [3 hidden, 16], padded
  Buffer<float> d_out;                    ///< [T, S, 2, 16], with respect to delta and band
  Buffer<float> d_gates;                  ///< as gates: w.r.t. pre-activations of r, z, n, and a
  Buffer<float> d_h;                      ///< [S, hidden], scratch
};

Launch gru_rollout(Runtime& runtime, const GruArrays& arrays);
Launch gru_rollout_backward(Runtime& runtime, const GruArrays& arrays,
                            const GruGradients& gradients);

}  // namespace touchtrace
