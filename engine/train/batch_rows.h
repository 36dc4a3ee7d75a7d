#pragma once

#include <algorithm>

#include "engine/model/model.h"
#include "engine/train/touch_embedder.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Throws failure if an array of the batch does not have the size that `spec` asks for, data_error
/// if a window reaches outside a stream of `frames` frames.
void check(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames);

/// The same for what the batch says of its objects.
void check_objects(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames,
                   Model::Use use);

/// The windows of a batch of the model's size.
void write_windows(Runtime& runtime, const Model& model, const RolloutBatch& batch);

/// A block of a batch as a model takes it: as many sequences and steps as the model has, from the
/// given ones on. Where the batch ends, its last sequence and step repeat.
struct BatchBlock {
  const RolloutBatch& batch;
  int first_sequence = 0, first_step = 0;

  /// Of the batch, which the model takes as its sequence s or step t.
  int sequence(int s) const { return std::min(first_sequence + s, batch.sequences - 1); }
  int step(int t) const { return std::min(first_step + t, batch.steps - 1); }
};

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
/// e_i of the block's sequences, from those of all sequences of the batch.
void write_object_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                             const TouchEmbeddings& of_sequences);
/// g_t of the block's steps, from those of all steps [sequence, step] of the batch.
void write_tactile_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                              const TouchEmbeddings& of_steps);

}  // namespace touchtrace
