#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"
#include "engine/train/rollout_batch.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// A trained model on one device.
class Predictor {
 public:
  /// Takes a file of Trainer::model_file(). Throws data_error if it is invalid.
  Predictor(Runtime& runtime, TensorFile model);
  /// Reads a model that Trainer::save wrote. Throws data_error if the file is invalid.
  Predictor(Runtime& runtime, const std::filesystem::path& model);
  ~Predictor();

  const ModelSpec& spec() const;
  const nlohmann::json& metadata() const;  ///< as passed to Trainer::save
  /// Rolls out any number of sequences and steps. `tactile`: [frames, rows, cols], indexed by
  /// batch.first_frame. A prediction depends on no other sequence of the batch, not even in the
  /// last bit. Throws data_error if a window is outside the stream.
  Rollout predict(const RolloutBatch& batch, std::span<const float> tactile);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchtrace
