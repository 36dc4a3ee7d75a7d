#pragma once

#include "engine/model/parameters.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Weight decay of each parameter, for Adam: of matrices and convolutions, not of biases and gains.
Buffer<float> decays(Runtime& runtime, const ParameterTable& table, double weight_decay);

/// From `options.learning_rate` to 0 by a half cosine.
double learning_rate(const TrainOptions& options, int update);

}  // namespace touchtrace
