#pragma once

#include <cstdint>

namespace touchtrace {

struct TrainOptions {
  int updates = 3000;
  double learning_rate = 2e-3;    ///< initial; half-cosine decay to 0
  double weight_decay = 0.1;      ///< decoupled (AdamW)
  double clip_norm = 1.0;         ///< maximum norm of the whole gradient
  double taxel_dropout = 0.2;     ///< fraction of taxels zeroed in an update
  double object_loss = 0.1;       ///< lambda_obj: weight of the contrastive loss (equation 6)
  int max_consecutive_skips = 0;  ///< updates skipped in a row because they are not finite
  std::uint64_t seed = 1;         ///< of initial weights and dropout
};

}  // namespace touchtrace
