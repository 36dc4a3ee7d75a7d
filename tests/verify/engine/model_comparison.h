#pragma once

#include <cstdint>
#include <functional>

#include "engine/train/trainer.h"
#include "tests/verify/engine/model_reference.h"

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

/// `frame_value` changes the values of the noise that the tactile frames hold; empty: none.
ModelComparison compare_model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const TaxelDropout& dropout, std::uint64_t seed,
                              const std::function<float(float)>& frame_value = {});

/// The first comparison from `seed` on, which moves there, in which float and double pass every
/// kink of the dynamics MLP and the loss on the same side.
ModelComparison compare_away_from_kinks(Runtime& runtime, const ModelSpec& spec, int sequences,
                                        int steps, std::uint32_t& seed,
                                        const std::function<float(float)>& frame_value = {});

/// ||actual - reference|| / ||reference||
double relative_distance(const std::vector<double>& actual, const std::vector<double>& reference);

}  // namespace touchtrace
