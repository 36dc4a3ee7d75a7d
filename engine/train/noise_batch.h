#pragma once

#include <vector>

#include "engine/base/random.h"
#include "engine/train/trainer.h"

namespace touchtrace {

// Random streams and batches, to measure and test training without a recording.

/// Standard normal frames [frames, rows, cols].
std::vector<float> noise_stream(const ModelSpec& spec, int frames, RandomStream& random);

/// Roll-outs with random states, targets and weights, from random frames of a stream of `frames`.
/// With an object encoder: three objects, each sequence with a segment from a random frame.
RolloutBatch noise_batch(const ModelSpec& spec, int sequences, int steps, int frames,
                         RandomStream& random);

/// Random embeddings of the objects of noise_batch(), without an encoder.
FrozenObjects noise_objects(const ModelSpec& spec, RandomStream& random);

}  // namespace touchtrace
