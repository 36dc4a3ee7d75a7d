#pragma once

#include "engine/base/random.h"
#include "engine/model/touch_encoder.h"
#include "engine/train/trainer.h"

namespace touchtrace {

/// A training on one batch of noise, to look into what its updates do and what they take.
class NoiseTraining {
 public:
  /// `live`: the stream is zero for taxels that are not.
  NoiseTraining(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                const Tuning& tuning = {}, const LiveTaxels& live = {},
                const TrainOptions& options = {});

  /// Its loss.
  double update() { return trainer_.update(batch_); }

 private:
  RandomStream random_;
  Trainer trainer_;
  RolloutBatch batch_;
};

}  // namespace touchtrace
