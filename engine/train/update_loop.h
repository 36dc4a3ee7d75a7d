#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/random.h"
#include "engine/model/weights.h"
#include "engine/ops/adam.h"
#include "engine/train/checkpoint_metadata.h"
#include "engine/train/train_options.h"

namespace touchtrace {

/// Weight updates of a model on one device: initial weights, Adam with a cosine learning rate,
/// dropout keys, and updates that are not finite. Used by Trainer and ObjectTrainer.
class UpdateLoop {
 public:
  /// Random numbers of an update, for dropout.
  using Keys = std::array<std::uint32_t, 4>;
  struct Functions {
    std::function<void(const Keys&)> pass;       ///< enqueues prepare, forward and backward
    std::function<std::string()> invalid_input;  ///< names a batch input that is not finite, if any
  };

  struct Names {
    std::string update;          ///< in messages: "update", "object encoder update"
    std::string dropout_stream;  ///< random stream of the keys
  };

  /// Initialises the weights and uploads `tactile`. `loss`: [1], written by the pass.
  UpdateLoop(Runtime& runtime, const TrainOptions& options, const Weights& weights,
             const Buffer<float>& loss, Names names, std::span<const float> tactile);

  /// One update on the batch that the caller uploaded. Returns the loss before it. If loss or
  /// gradient is not finite, the weights stay: returns NaN with a warning, or throws Error(failed)
  /// after max_consecutive_skips in a row.
  double update(const Functions& functions);

  const Buffer<float>& stream() const { return stream_; }  ///< [frames, rows, cols]
  const UpdateCounts& counts() const { return counts_; }
  /// For a checkpoint: state of the optimiser by tensor name.
  std::vector<std::pair<std::string, Buffer<float>>> optimiser_state() const {
    return adam_.state();
  }
  void resume(const UpdateCounts& counts) { counts_ = counts; }

 private:
  Keys keys() const;
  double skip(const Functions& functions);
  /// Describes what is not finite in the last update.
  std::string find_cause(const Functions& functions);

  Runtime& runtime_;
  TrainOptions options_;
  Weights weights_;
  Buffer<float> loss_, stream_;
  Names names_;
  RandomStream dropout_keys_;
  Adam adam_;
  UpdateCounts counts_;
};

}  // namespace touchtrace
