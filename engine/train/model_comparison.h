#pragma once

#include <cstdint>

#include "engine/model/model_reference.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// One training step of a fresh model on noise, on a device and in plain loops in double.
struct ModelComparison {
  ParameterTable table;
  LossAndGradient device, reference;
  std::vector<double> parameters;
  ModelProblem problem;

  double loss_error() const;      ///< relative
  double gradient_error() const;  ///< relative, in norm; NaN if the device gives one
};

ModelComparison compare_model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const TaxelDropout& dropout, std::uint64_t seed);

/// ||actual - reference|| / ||reference||
double relative_distance(const std::vector<double>& actual, const std::vector<double>& reference);

}  // namespace touchtrace
