#pragma once

#include <filesystem>

#include "pipeline/study/model_card.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// The validation clips of a data set: what training may look at without learning from it.
class Validation {
 public:
  Validation(Runtime& runtime, const Dataset& data, const ModelCard& card);

  /// True if the validation clips are too short or too few to look at.
  bool empty() const { return cases_.count() == 0; }
  /// Fills the validation fields of `entry` for the weights in a file.
  void look(const std::filesystem::path& weights, TrainingLogEntry& entry) const;
  /// The band's factors for the weights in a file; empty if there is nothing to fit them on.
  BandScale band_scale(const std::filesystem::path& weights) const;

 private:
  Rollout predict(const std::filesystem::path& weights) const;

  Runtime& runtime_;
  const Dataset& data_;
  RolloutCases cases_;
  double band_quantile_;
};

}  // namespace touchtrace::study
