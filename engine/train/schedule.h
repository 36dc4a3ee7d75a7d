#pragma once

#include "engine/cl/runtime.h"
#include "engine/model/parameters.h"
#include "engine/train/train_options.h"

namespace touchtrace {

/// Weight decay of each parameter, for Adam: `weight_decay` for matrices and convolutions, 0 for
/// biases and gains.
Buffer<float> decays(Runtime& runtime, const ParameterTable& table, double weight_decay);

/// Learning rate of an update: half a cosine from options.learning_rate to 0.
double learning_rate(const TrainOptions& options, int update);

}  // namespace touchtrace
