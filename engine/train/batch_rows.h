#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "engine/model/model.h"
#include "engine/train/rollout_batch.h"
#include "engine/train/tactile_embedder.h"

namespace touchtrace {

// Checks batches and writes them to the inputs of a Model, in its row order [T, S].

/// Throws failure if an array of the batch does not have the size that `spec` requires, data_error
/// if a window is outside a stream of `frames` frames.
void check(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames);

/// The same for the batch's objects and segments.
void check_objects(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames,
                   Model::Use use);

/// Writes the window ends of a batch of the model's size.
void write_windows(Runtime& runtime, const Model& model, const RolloutBatch& batch);

/// Block of a batch of the model's size, from the given sequence and step on. Beyond the end of the
/// batch its last sequence and step are repeated.
struct BatchBlock {
  const RolloutBatch& batch;
  int first_sequence = 0, first_step = 0;

  /// Index in the batch of the model's sequence s or step t.
  int sequence(int s) const { return std::min(first_sequence + s, batch.sequences - 1); }
  int step(int t) const { return std::min(first_step + t, batch.steps - 1); }
};

/// `initial`: [batch.sequences, state].
void write_initial_states(Runtime& runtime, const Model& model, const BatchBlock& block,
                          std::span<const float> initial);
/// Writes targets, and weights divided by their sum and by the state size, so that the loss is a
/// mean. Throws data_error if all weights are zero.
void write_targets(Runtime& runtime, const Model& model, const RolloutBatch& batch);

/// With ObjectEncoder::joint in training: writes objects, segments and the weights of the
/// contrastive loss, times `object_loss`. Otherwise does nothing.
void write_segments(Runtime& runtime, const Model& model, const RolloutBatch& batch,
                    double object_loss);
/// Writes row `row`[s] of `embedding` [rows, embedding] for each sequence s of the model. Throws
/// failure for a row that does not exist.
void write_object_embeddings(Runtime& runtime, const Model& model,
                             std::span<const std::int32_t> row, std::span<const float> embedding);
/// Writes e_i of the block's sequences. `of_sequences`: of all sequences of the batch.
void write_object_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                             const DistinctEmbeddings& of_sequences);
/// Writes g_t of the block's steps. `of_steps`: of all steps [S, T] of the batch.
void write_tactile_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                              const DistinctEmbeddings& of_steps);

}  // namespace touchtrace
