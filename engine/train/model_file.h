#pragma once

#include <filesystem>

#include "engine/cl/runtime.h"
#include "engine/model/model.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// What Trainer::save wrote: all that a predictor starts from.
struct ModelFile {
  TensorFile file;
  ModelSpec spec;
  nlohmann::json metadata;  ///< as given to Trainer::save

  /// The model with the file's weights, ready for forward passes. Throws data_error if a weight is
  /// missing or has another size.
  std::unique_ptr<Model> make(Runtime& runtime, int sequences, int steps, Model::Use use) const;
};

/// Throws data_error for a file that is none of Trainer::save's.
ModelFile read_model_file(const std::filesystem::path& path);

}  // namespace touchtrace
