#pragma once

#include <vector>

#include "engine/train/trainer.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Roll-outs that a model is asked for and held against. `batch` is scaled; its weight is 0 at
/// steps whose target is not to be trusted.
struct RolloutCases {
  RolloutBatch batch;
  std::vector<int> sequence;  ///< [batch.sequences], into Dataset::sequences

  int count() const { return batch.sequences; }
  std::size_t path_size() const { return static_cast<std::size_t>(batch.steps) * state_size; }
};

/// What predictions are held against: the vision pipeline's labels, or what really happened.
enum class Reference { labels, truth };

struct RolloutGrid {
  Split split = Split::evaluation;
  int steps = 50, stride = 10;  ///< frames from one start to the next
  int history = 10;             ///< frames that must lie before a start, itself included
};

/// Frames of touch that a model must have seen when a roll-out starts: its window, and the segment
/// that the object is known from.
int history_of(const ModelSpec& spec);

/// Every `stride`-th start in the clips of a split, with its sequence. A roll-out lies within its
/// clip, its first window included; starts whose label is a guess are left out.
struct Start {
  int sequence, frame;
};
std::vector<Start> starts_of(const Dataset& data, const RolloutGrid& grid);

/// Appends the roll-out from `start` on. It starts at the causal label, which is what is known at
/// test time. Against labels, steps whose label is a guess weigh 0; against truth every step
/// counts.
void append_rollout(RolloutBatch& batch, const Dataset& data, const Normalization& scaling,
                    Reference reference, int start);

/// The object of each roll-out is to be known from the beginning of its clip (section IV-B).
RolloutCases make_cases(const Dataset& data, const RolloutGrid& grid, const Normalization& scaling,
                        Reference reference);

/// The mean loss of equation 4 over states, steps and roll-outs: what training makes small.
double mean_loss(const Rollout& rollout, const RolloutBatch& batch, double band_quantile);

/// States, or a roll-out, scaled in another way.
std::vector<float> rescaled(const std::vector<float>& states, const Normalization& from,
                            const Normalization& to);
Rollout rescaled(const Rollout& rollout, const Normalization& from, const Normalization& to);

/// For each case the target of a random other one, from another clip where there is one: the
/// baseline "Random" (section IV-B). Needs two cases. [cases, steps, 12]
std::vector<float> random_paths(const RolloutCases& cases, std::uint64_t seed);

}  // namespace touchtrace::study
