#pragma once

#include "engine/model/model.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Throws failure if an array of the batch does not have the size that `spec` asks for, data_error
/// if a window reaches outside a stream of `frames` frames.
void check(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames);

/// The same for what the batch says of its objects.
void check_objects(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames,
                   Model::Use use);

/// A block of a batch as a model takes it: as many sequences and steps as the model has, from the
/// given ones on. Where the batch ends, its last sequence and the stream's last frame repeat.
struct BatchBlock {
  const RolloutBatch& batch;
  int first_sequence = 0, first_step = 0;
};

void write_windows(Runtime& runtime, const Model& model, const BatchBlock& block,
                   std::size_t frames);
/// `initial`: [batch.sequences, state].
void write_initial_states(Runtime& runtime, const Model& model, const BatchBlock& block,
                          std::span<const float> initial);
/// Targets, and weights divided by their sum and the state's size, so that the loss is a mean.
/// Throws data_error if no step has a weight.
void write_targets(Runtime& runtime, const Model& model, const RolloutBatch& batch);

/// Where the model trains its object encoder: the sequences' objects and segments, and the weights
/// of the contrastive loss, which counts `object_loss` times.
void write_segments(Runtime& runtime, const Model& model, const RolloutBatch& batch,
                    double object_loss);
/// Elsewhere: row `row`[s] of `embedding` [rows, embedding] for each sequence s of the model.
/// Throws failure if there is no such row.
void write_object_embeddings(Runtime& runtime, const Model& model,
                             std::span<const std::int32_t> row, std::span<const float> embedding);

}  // namespace touchtrace
