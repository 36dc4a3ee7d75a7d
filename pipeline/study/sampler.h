#pragma once

#include <vector>

#include "engine/base/random.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Random roll-outs of the training clips. A batch depends on the seed and its number alone, so
/// training can stop and go on anywhere.
class Sampler {
 public:
  /// `data` must outlive the sampler. Throws data_error if no training clip holds one roll-out.
  Sampler(const Dataset& data, const Normalization& scaling, const ModelSpec& spec, int sequences,
          int steps, std::uint64_t seed);

  /// Batch number `index`: every start in the training clips is equally likely. With an object
  /// encoder each sequence has its object's number, in the order of the training objects' names,
  /// and any segment of its clip.
  RolloutBatch batch(int index) const;

 private:
  void append_object(RolloutBatch& batch, int sequence, std::uint64_t draw) const;

  const Dataset& data_;
  Normalization scaling_;
  ModelSpec spec_;
  int sequences_, steps_;
  std::vector<Start> starts_;
  std::vector<int> object_;  ///< number of each of Dataset::sequences
  RandomStream random_, segments_;
};

}  // namespace touchtrace::study
