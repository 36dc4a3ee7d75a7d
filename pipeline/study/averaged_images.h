#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/model/model_spec.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Tactile images [frames, rows, cols] of a data set, averaged to a model's resolution; nullopt:
/// they have it, or the model uses no touch. Throws data_error if the glove has fewer taxels than
/// the model's images; `model` and `recording`: names for its message.
std::optional<std::vector<float>> averaged_images(const ModelSpec& spec, const std::string& model,
                                                  const Dataset& data,
                                                  const std::string& recording);

}  // namespace touchtrace::study
