#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/provenance.h"
#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"
#include "engine/ops/tuning.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// S sequences of T roll-out steps. Step k sees the window that ends at frame first_frame[s] + k
/// and predicts the state of frame first_frame[s] + k + 1 (equation 1). All states are scaled.
struct RolloutBatch {
  int sequences = 0, steps = 0;
  std::vector<std::int32_t>
      first_frame;                   ///< [S], into the tactile stream; at least window_frames - 1
  std::vector<float> initial_state;  ///< [S, state]
  std::vector<float> target;         ///< [S, T, state]; empty for prediction
  std::vector<float> weight;         ///< [S, T], 0 where a label is not to be trusted; empty: all 1

  /// For a model with an object encoder, else empty, [S]: a number for the object in hand, and the
  /// first of the segment_frames frames, of the same clip, that e_i is made from. Training with
  /// ObjectEncoder::frozen needs the first alone, prediction the second alone.
  std::vector<std::int32_t> object{}, segment_frame{};
};

/// Predicted states and the distance to their quantiles Q and 1 - Q, Q the spec's band_quantile;
/// both [S, T, state], scaled.
struct Rollout {
  std::vector<float> state, spread;
};

struct TrainOptions {
  int updates = 3000;
  double learning_rate = 2e-3;  ///< at the start; falls to 0 by a half cosine
  double weight_decay = 0.1;    ///< decoupled (AdamW)
  double clip_norm = 1.0;       ///< of the whole gradient
  double taxel_dropout = 0.2;   ///< share of taxels blanked in an update
  double object_loss = 0.1;     ///< lambda_obj: weight of the contrastive loss (equation 6)
  int skips_in_a_row = 0;       ///< updates left out before a loss that is not finite is an error
  std::uint64_t seed = 1;
};

/// An object encoder that is trained no further, and what it says of the objects of the batches.
struct FrozenObjects {
  std::vector<Tensor> encoder;   ///< "object.conv1.weight" and so on
  std::vector<float> embedding;  ///< [objects, embedding]: RolloutBatch::object numbers its rows
};

/// The weights of a model on one device, its gradient, its optimiser and one fixed plan of
/// launches.
class Trainer {
 public:
  /// `tactile`: [frames, rows, cols], uploaded once; may be empty for a spec without touch.
  /// `tuning`: decides the last bits of everything learnt, so that a run goes on to the same bits
  /// only with that of its checkpoint.
  Trainer(Runtime& runtime, const ModelSpec& spec, const TrainOptions& options, int sequences,
          int steps, std::span<const float> tactile, const Tuning& tuning = {});
  ~Trainer();

  /// To be called before the first update of a model with ObjectEncoder::frozen. The encoder's
  /// weights are saved with the model's and in checkpoints.
  void freeze_objects(FrozenObjects objects);

  /// One update of L1 + pinball(Q) + pinball(1 - Q) (equation 4) by back-propagation through time;
  /// where the object encoder is trained along, of this plus lambda_obj times the contrastive loss
  /// of the sequences' segments (equation 6): the other sequences of the batch with the same object
  /// are a sequence's positives, those with another object its negatives. A sequence without either
  /// is left out of that mean. Returns the loss before the update. Where loss or gradient is not
  /// finite the weights stay: the update is left out, with a warning and NaN for the loss, or
  /// throws Error(failed) after `skips_in_a_row` of them. Both name the first operation that made
  /// such a value.
  double update(const RolloutBatch& batch);
  /// Updates done so far, those left out included. The random streams and the place in the data
  /// follow from this number alone.
  int updates() const;

  /// Weights in safetensors; `metadata` holds the spec, the scaling and the provenance.
  void save(const std::filesystem::path& path, const nlohmann::json& metadata,
            bool overwrite) const;
  /// Weights, optimiser state and position, to go on exactly where it stopped, in one file; `notes`
  /// are the caller's.
  void save_checkpoint(const std::filesystem::path& path, const nlohmann::json& notes = {}) const;
  /// Throws data_error, and changes nothing, if it is another model's, of other choices or damaged.
  void load_checkpoint(const std::filesystem::path& path);
  /// The notes of a checkpoint alone. Throws data_error if it is none.
  static nlohmann::json checkpoint_notes(const std::filesystem::path& path);
  /// The choices that the checkpoint was started with, for the trainer that goes on from it. Throws
  /// data_error as well.
  static Tuning checkpoint_tuning(const std::filesystem::path& path);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

/// A trained model on one device.
class Predictor {
 public:
  Predictor(Runtime& runtime, const std::filesystem::path& model);
  ~Predictor();

  const ModelSpec& spec() const;
  const nlohmann::json& metadata() const;  ///< as given to Trainer::save
  /// `tactile`: the stream that batch.first_frame points into; any S and T.
  Rollout predict(const RolloutBatch& batch, std::span<const float> tactile);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace touchtrace
