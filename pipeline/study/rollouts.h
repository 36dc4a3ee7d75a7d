#pragma once

#include <vector>

#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Roll-outs with targets. `batch` is normalised; weight 0 marks steps without a trusted target.
struct RolloutCases {
  RolloutBatch batch;
  std::vector<int> sequence;  ///< [batch.sequences], into Dataset::sequences

  int count() const { return batch.sequences; }
  std::size_t path_size() const { return static_cast<std::size_t>(batch.steps) * state_size; }
};

/// Source of targets: the vision pipeline's labels, the simulation's truth shifted onto the labels
/// (truth.h), or the truth as simulated.
enum class Reference { labels, truth, unshifted_truth };

/// Starts of roll-outs.
struct RolloutGrid {
  Split split = Split::evaluation;
  int steps = 50, stride = 10;  ///< frames between starts
  int history = 10;             ///< frames required up to the start, inclusive
};

/// Frames of touch that a model needs up to a start: its window and, with an object encoder, the
/// segment that identifies the object.
int required_history(const ModelSpec& spec);

/// Start of a roll-out.
struct Start {
  int sequence, frame;
};

/// Every `stride`-th start in the clips of a split, such that history and steps are inside the clip
/// and the label is trusted.
std::vector<Start> find_starts(const Dataset& data, const RolloutGrid& grid);

/// Appends the roll-out that begins at frame `start`. The initial state is the filtered label,
/// which no later measurement enters. Weights: 1 for truth; for labels 1 if trusted, else 0.
void append_rollout(RolloutBatch& batch, const Dataset& data, const Normalization& scaling,
                    Reference reference, int start);

/// All roll-outs of a grid. Each identifies its object from the beginning of its clip (section
/// IV-B).
RolloutCases make_cases(const Dataset& data, const RolloutGrid& grid, const Normalization& scaling,
                        Reference reference);

bool is_finite(const Rollout& rollout);

/// Mean training loss (equation 4) over states, steps and roll-outs; NaN if all weights are 0.
double mean_loss(const Rollout& rollout, const RolloutBatch& batch, double band_quantile);

/// Converts normalised states or roll-outs to another normalisation.
std::vector<float> rescaled(const std::vector<float>& states, const Normalization& from,
                            const Normalization& to);
Rollout rescaled(const Rollout& rollout, const Normalization& from, const Normalization& to);

}  // namespace touchtrace::study
