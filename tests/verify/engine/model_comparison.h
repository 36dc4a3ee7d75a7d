#pragma once

#include <cstdint>
#include <functional>

#include "engine/train/trainer.h"
#include "tests/verify/engine/model_reference.h"

namespace touchtrace {

/// Loss and gradient of a freshly initialised model on random data, from a device and from the
/// reference in double.
struct ModelComparison {
  ParameterTable table;
  LossAndGradient device, reference;
  std::vector<double> parameters;
  ModelProblem problem;

  double loss_error() const;      ///< relative
  double gradient_error() const;  ///< norm_error()
};

/// `frame_value`: applied to each standard normal taxel value; empty: identity.
ModelComparison compare_model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const TaxelDropout& dropout, std::uint64_t seed,
                              const std::function<float(float)>& frame_value = {});

/// First comparison from `seed` on in which float and double are on the same side of every kink of
/// the dynamics MLP and the loss. Sets `seed` to the seed that it used.
ModelComparison compare_away_from_kinks(Runtime& runtime, const ModelSpec& spec, int sequences,
                                        int steps, std::uint32_t& seed,
                                        const std::function<float(float)>& frame_value = {});

}  // namespace touchtrace
