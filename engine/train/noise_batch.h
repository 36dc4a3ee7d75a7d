#pragma once

#include <vector>

#include "engine/base/random.h"
#include "engine/train/trainer.h"

namespace touchtrace {

// Streams and batches of noise, for figures and tests.

/// [frames, rows, cols]
std::vector<float> noise_stream(const ModelSpec& spec, int frames, RandomStream& random);

/// Roll-outs with noise for states, targets and weights, from any frame of a stream of `frames`;
/// with an object encoder of three objects, each with a segment from any frame.
RolloutBatch noise_batch(const ModelSpec& spec, int sequences, int steps, int frames,
                         RandomStream& random);

/// Embeddings of the objects of noise_batch, with no encoder behind them.
FrozenObjects noise_objects(const ModelSpec& spec, RandomStream& random);

}  // namespace touchtrace
