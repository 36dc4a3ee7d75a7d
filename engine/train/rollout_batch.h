#pragma once

#include <cstdint>
#include <vector>

namespace touchtrace {

/// S sequences of T roll-out steps. Step k sees the window that ends at frame first_frame[s] + k
/// and predicts the state of frame first_frame[s] + k + 1 (equation 1). All states are scaled.
struct RolloutBatch {
  int sequences = 0, steps = 0;
  std::vector<std::int32_t>
      first_frame;                   ///< [S] into the tactile stream; at least window_frames - 1
  std::vector<float> initial_state;  ///< [S, state]
  std::vector<float> target;         ///< [S, T, state]; empty for prediction
  std::vector<float> weight;         ///< [S, T], 0: ignore the label; empty: all 1

  // With an object encoder, [S]. Training with ObjectEncoder::frozen needs only `object`,
  // prediction only `segment_frame`.
  std::vector<std::int32_t> object{};         ///< object index
  std::vector<std::int32_t> segment_frame{};  ///< first frame of the segment, of the same clip
};

/// Predicted states and spreads, the distances to the quantiles Q and 1 - Q (Q:
/// ModelSpec::band_quantile). Both [S, T, state], scaled.
struct Rollout {
  std::vector<float> state, spread;
};

}  // namespace touchtrace
