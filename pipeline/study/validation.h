#pragma once

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
  /// Fills the validation fields of `entry` for a model.
  void evaluate(const TensorFile& model, TrainingLogEntry& entry) const;
  /// Fits the band scale of a model; empty without calibration clips and, with a warning, if it
  /// predicts values that are not finite.
  BandScale band_scale(const TensorFile& model) const;

 private:
  Rollout predict(const TensorFile& model, const RolloutCases& cases) const;

  Runtime& runtime_;
  const Dataset& data_;
  RolloutCases cases_, calibration_;
  double band_quantile_;
};

}  // namespace touchtrace::study
