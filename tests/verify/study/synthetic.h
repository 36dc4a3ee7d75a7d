#pragma once

#include <cstdint>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

struct SyntheticOptions {
  int clips = 20, frames = 120;  ///< of a clip, at 15 Hz
  int rows = 8, cols = 8;
  std::uint64_t seed = 1;
  int objects = 1;  ///< alternate from clip to clip
};

/// Smallest problem on which touch must help: a hand on a spring is driven by a random force that
/// only the tactile frames show (three bands of taxels, one per component, with 1 % noise). Each of
/// several objects ("ball", "object 1", "object 2", ...) also presses on its own columns and shows
/// another fraction of the force. The object stays 5 cm above the hand. Clips: 60 % training, 7.5 %
/// validation, 7.5 % calibration, 25 % evaluation. Labels, causal labels and truth are equal.
Dataset synthetic_dataset(const SyntheticOptions& options = {});

}  // namespace touchtrace::study
