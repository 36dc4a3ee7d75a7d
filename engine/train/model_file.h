#pragma once

#include <filesystem>
#include <memory>

#include "engine/cl/runtime.h"
#include "engine/model/model.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Contents of a file that Trainer::save wrote.
struct ModelFile {
  TensorFile file;
  ModelSpec spec;
  nlohmann::json metadata;  ///< as passed to Trainer::save

  /// Makes a model with the file's weights, ready for forward passes. Throws data_error if a weight
  /// is missing or has another size.
  std::unique_ptr<Model> make(Runtime& runtime, int sequences, int steps, Model::Use use) const;
};

/// Safe for untrusted files. Throws data_error that names the file and, for an invalid
/// specification, key, value and expected range.
ModelFile parse_model_file(TensorFile file);
ModelFile read_model_file(const std::filesystem::path& path);

}  // namespace touchtrace
