#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// Compares all image trackers on wave, throw and pingpong at two image sizes: lost labels,
/// position errors and CPU time, with a plot of error over time.
void measure_trackers(const std::function<void(Figure)>& emit, Progress& progress);
/// Number of steps of `progress`: one per recording and tracker.
std::uint64_t tracker_trials();

}  // namespace touchtrace::study
