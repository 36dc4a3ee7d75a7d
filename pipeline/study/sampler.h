#pragma once

#include <vector>

#include "engine/base/random.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Samples roll-outs of the training clips. A batch depends only on the seed and its index, so that
/// training can resume at any update.
class Sampler {
 public:
  /// `data` must outlive the sampler. Throws data_error if no training clip is long enough.
  Sampler(const Dataset& data, const Normalization& scaling, const ModelSpec& spec, int sequences,
          int steps, std::uint64_t seed);

  /// Batch with uniformly drawn starts. With an object encoder each sequence has its object's index
  /// in training_objects() and a random segment of its clip.
  RolloutBatch batch(int index) const;

 private:
  void append_object(RolloutBatch& batch, int sequence, std::uint64_t draw) const;

  const Dataset& data_;
  Normalization scaling_;
  ModelSpec spec_;
  int sequences_, steps_;
  std::vector<Start> starts_;
  std::vector<int> object_;  ///< [Dataset::sequences] object index
  RandomStream random_, segments_;
};

}  // namespace touchtrace::study
