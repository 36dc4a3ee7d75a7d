#pragma once

#include "engine/base/random.h"
#include "engine/model/conv_stack_shape.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// Training on one random batch, to measure updates without a recording.
class NoiseTraining {
 public:
  /// `live`: the stream is zero for the other taxels.
  NoiseTraining(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                const LiveTaxels& live = {}, const TrainOptions& options = {});

  /// Returns the loss before the update.
  double update() { return trainer_.update(batch_); }

 private:
  RandomStream random_;
  Trainer trainer_;
  RolloutBatch batch_;
};

}  // namespace touchtrace
