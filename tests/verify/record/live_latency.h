#pragma once

#include <filesystem>
#include <vector>

#include "tests/verify/record/live_rows.h"

namespace touchtrace {

struct LiveLatency {
  // Sorted; one for each line:
  std::vector<double> seconds;          ///< from the moment a frame is sent to its line
  std::vector<double> program_seconds;  ///< of that, since the program has read the last byte
};

/// Latency of `touchtrace predict --glove`, in a process of its own, with a glove on a
/// pseudo-terminal that sends `frames` frames of 32 x 32 taxels at `rate_hz`, and a default model.
/// Another process keeps one core busy. `folder`: for the model.
LiveLatency measure_live_latency(const std::filesystem::path& folder, double rate_hz, int frames);

/// Compares `predict --glove` of a file with `predict --recording` of what `record` made of it: 600
/// frames and a model with an object encoder.
RowComparison compare_live_with_recorded(const std::filesystem::path& folder);

}  // namespace touchtrace
