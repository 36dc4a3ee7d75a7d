#pragma once

#include "engine/model/model.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Throws failure if an array of the batch does not have the size that `spec` asks for, data_error
/// if a window reaches outside a stream of `frames` frames.
void check(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames);

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

/// The objects of the sequences, their segments, and their weights in the contrastive loss, of
/// which `object_loss` times the mean over anchors and over an anchor's positives is taken. For a
/// model that trains its object encoder.
void write_segments(Runtime& runtime, const Model& model, const RolloutBatch& batch,
                    double object_loss);

}  // namespace touchtrace
