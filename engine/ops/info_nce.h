#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// InfoNCE over a batch of embeddings (equation 5, minimised: the negative logarithm). Embeddings
/// of the same object are each other's positives, those of other objects the negatives. Accurate to
/// 1e-6 relative for logits up to 1e4.
struct InfoNceArrays {
  int count, columns;       ///< N, and the size of an embedding, a multiple of 16
  float temperature;        ///< 0: logits are dot products; else those of unit vectors, over it
  Buffer<float> embedding;  ///< [N, columns]
  Buffer<int> object;       ///< [N]
  Buffer<float> weight;     ///< [N], of an anchor's every positive, the mean's divisor included
  Buffer<float> row_loss;   ///< from `row_loss_at` on [N], weighted
  int row_loss_at;
  Buffer<float> grad_embedding;  ///< [N, columns]: what the sum of row_loss gives is added
};

Launches info_nce(Runtime& runtime, const InfoNceArrays& arrays);

}  // namespace touchtrace
