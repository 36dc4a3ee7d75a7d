#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/provenance.h"
#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"
#include "engine/train/rollout_batch.h"
#include "engine/train/safetensors.h"
#include "engine/train/train_options.h"

namespace touchtrace {

/// A trained object encoder and its mean embedding of each object.
struct FrozenObjects {
  std::vector<Tensor> encoder;   ///< "object.conv1.weight" and so on
  std::vector<float> embedding;  ///< [objects, embedding]; RolloutBatch::object indexes the rows
};

/// Training of a model on one device. Not thread-safe.
class Trainer {
 public:
  /// `tactile`: [frames, rows, cols], uploaded once; may be empty for a spec without touch.
  Trainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options, int sequences,
          int steps, std::span<const float> tactile);
  ~Trainer();

  /// Required before the first update with ObjectEncoder::frozen. The encoder's weights are saved
  /// with the model and with checkpoints.
  void freeze_objects(FrozenObjects objects);

  /// One update of L1 + pinball(Q) + pinball(1 - Q) (equation 4) by back-propagation through time.
  /// With ObjectEncoder::joint, lambda_obj times the contrastive loss of the sequences' segments is
  /// added (equation 6): sequences of the same object are positives, others negatives; a sequence
  /// without either does not count in that mean.
  ///
  /// Returns the loss before the update. If loss or gradient is not finite, the weights stay, and
  /// the update is skipped with a warning, returning NaN; after max_consecutive_skips in a row it
  /// throws Error(failed) instead. Both messages name the first operation with such a value.
  double update(const RolloutBatch& batch);
  /// Number of updates attempted, skipped ones included. Random streams and the position in the
  /// data depend on it alone.
  int updates() const;

  /// The weights, with the spec and the caller's `metadata` (scaling, provenance).
  TensorFile model_file(const nlohmann::json& metadata) const;
  /// Writes model_file() as safetensors.
  void save(const std::filesystem::path& path, const nlohmann::json& metadata,
            bool overwrite) const;
  /// Writes all that is needed to resume to the same bits: weights, optimiser state, counts
  /// and the caller's `notes` and `tensors`, whose names must differ from those of the others.
  void save_checkpoint(const std::filesystem::path& path, const nlohmann::json& notes = {},
                       const std::vector<Tensor>& tensors = {}) const;
  /// Throws data_error, and changes nothing, if the checkpoint is damaged or was written with
  /// another spec or accuracy.
  void load_checkpoint(const std::filesystem::path& path);
  /// Reads the notes of a checkpoint. Throws data_error if it is not one.
  static nlohmann::json checkpoint_notes(const std::filesystem::path& path);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchtrace
