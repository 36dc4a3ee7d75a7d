#pragma once

#include <string>
#include <vector>

#include "engine/train/safetensors.h"
#include "engine/train/trainer.h"

namespace touchtrace::testing {

/// What a peer computes too: the metadata "spec" (JSON), "sequences", "steps", perhaps "options"
/// (JSON: updates, learning_rate, weight_decay, object_loss, seed), and the tensors stream [frames,
/// rows, cols] and, one batch after the other, first_frame [S], initial_state [S, state], target
/// [S, T, state] and perhaps weight [S, T], for an object encoder object [S] and segment_frame [S];
/// perhaps weights of the model, too.
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
