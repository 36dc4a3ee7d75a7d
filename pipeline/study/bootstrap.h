#pragma once

#include <cstdint>
#include <vector>

namespace touchtrace::study {

/// [runs][roll-outs] Values of a metric; NaN where undefined. Runs: trainings with different seeds.
using RunValues = std::vector<std::vector<double>>;

/// Mean and 95 % interval; NaN where undefined.
struct Interval {
  double mean, low, high;
};

/// Mean over runs and roll-outs. The interval holds the middle 95 % of 2000 hierarchical bootstrap
/// samples: whole clips and runs are drawn with replacement. It is widened about the mean as
/// Student's interval for the number of clips is: samples of few clips vary too little. With one
/// run it does not cover other seeds. With one clip it is NaN. `clip` [roll-outs].
Interval bootstrap_mean(const RunValues& values, const std::vector<int>& clip, std::uint64_t seed);

/// Mean of a - b over roll-outs that are defined in all runs of both. Samples share their clips;
/// runs are drawn independently.
Interval bootstrap_difference(const RunValues& a, const RunValues& b, const std::vector<int>& clip,
                              std::uint64_t seed);

}  // namespace touchtrace::study
