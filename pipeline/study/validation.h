#pragma once

#include <filesystem>

#include "pipeline/study/model_card.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Validation clips, which select weights, and calibration clips, which fit the band scale. They
/// give no gradient.
class Validation {
 public:
  Validation(Runtime& runtime, const Dataset& data, const ModelCard& card);

  /// Whether no validation clip holds a roll-out.
  bool empty() const { return cases_.count() == 0; }
  /// Fills the validation fields of `entry` for the weights in a file.
  void evaluate(const std::filesystem::path& weights, TrainingLogEntry& entry) const;
  /// Fits the band scale of the weights in a file; empty without calibration clips.
  BandScale band_scale(const std::filesystem::path& weights) const;

 private:
  Rollout predict(const std::filesystem::path& weights, const RolloutCases& cases) const;

  Runtime& runtime_;
  const Dataset& data_;
  RolloutCases cases_, calibration_;
  double band_quantile_;
};

}  // namespace touchtrace::study
