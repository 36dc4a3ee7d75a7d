#pragma once

#include <string>
#include <vector>

#include "engine/train/safetensors.h"
#include "engine/train/trainer.h"

namespace touchtrace::testing {

/// Training problem in a safetensors file. Metadata: "spec" (JSON), "sequences", "steps" and
/// optionally "options" (JSON: updates, learning_rate, weight_decay, object_loss, seed). Tensors:
/// stream [frames, rows, cols]; for each batch, concatenated, first_frame [S], initial_state
/// [S, state], target [S, T, state], optionally weight [S, T] and, with an object encoder, object
/// [S] and segment_frame [S]; optionally the weights of the model.
struct Problem {
  TensorFile file;
  ModelSpec spec;
  TrainOptions options;
  std::vector<RolloutBatch> batches;
  std::vector<float> stream;

  std::size_t frames() const { return stream.size() / (std::size_t(spec.rows) * spec.cols); }
};

Problem read_problem(const std::string& path);

}  // namespace touchtrace::testing
