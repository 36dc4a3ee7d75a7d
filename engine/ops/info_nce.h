#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// InfoNCE loss over a batch of embeddings (equation 5; the paper omits the minus sign of the
/// logarithm). Embeddings of the same object are positives of each other, those of other objects
/// negatives. Relative error up to 1e-6 for logits up to 1e4.
struct InfoNceArrays {
  int count, columns;       ///< N, and the embedding size, a multiple of 16
  float temperature;        ///< 0: logits are dot products; else cosine / temperature
  Buffer<float> embedding;  ///< [N, columns]
  Buffer<int> object;       ///< [N]
  Buffer<float> weight;     ///< [N] weight of each positive pair of an anchor
  Buffer<float> row_loss;   ///< [N] weighted losses, from index `row_loss_at` on
  int row_loss_at;
  Buffer<float> grad_embedding;  ///< [N, columns]; the gradient of sum(row_loss) is added
};

Launches info_nce(Runtime& runtime, const InfoNceArrays& arrays);

}  // namespace touchtrace
