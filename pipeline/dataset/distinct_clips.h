#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace touchtrace {

/// Refuses recordings that have touch or motion in common: copies are no further evidence, but
/// would narrow intervals and weigh twice in training.
class DistinctClips {
 public:
  /// Adds the clips of a recording. Throws data_error if one of them, whole or in part, is also in
  /// a recording that was added before.
  void add(std::span<const Sequence> clips, const std::string& recording);

 private:
  std::vector<std::string> known_;  ///< fingerprints, sorted
};

}  // namespace touchtrace
