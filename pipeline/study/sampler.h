#pragma once

#include <vector>

#include "engine/base/random.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Random roll-outs of the training clips. A batch depends on the seed and its number alone, so
/// training can stop and go on anywhere.
class Sampler {
 public:
  /// `history`: frames of a window. `data` must outlive the sampler. Throws data_error if no
  /// training clip holds one roll-out.
  Sampler(const Dataset& data, const Normalization& scaling, int sequences, int steps, int history,
          std::uint64_t seed);

  /// Batch number `index`: every start in the training clips is equally likely.
  RolloutBatch batch(int index) const;

 private:
  const Dataset& data_;
  Normalization scaling_;
  int sequences_, steps_;
  std::vector<int> starts_;
  RandomStream random_;
};

}  // namespace touchtrace::study
