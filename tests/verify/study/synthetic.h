#pragma once

#include <cstdint>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

struct SyntheticOptions {
  int clips = 20, frames = 120;  ///< of a clip, at 15 Hz
  int rows = 8, cols = 8;
  std::uint64_t seed = 1;
  int objects = 1;  ///< taken up in turn, clip by clip
};

/// The smallest problem on which touch must help: a hand on a spring is pushed about by a force
/// that nothing but the tactile frames shows (three bands of taxels, one a component, with 1 %
/// noise). Of several objects each presses on columns of its own, and each shows another share of
/// the force: "ball", then "object 1", "object 2", ... The object stays 5 cm above the hand. 60 %
/// of the clips are for training, 15 % for validation, 25 % for evaluation. Labels, causal labels
/// and truth are equal. For tests and `touchtrace-verify study`.
Dataset synthetic_dataset(const SyntheticOptions& options = {});

}  // namespace touchtrace::study
