#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "tests/verify/support/figure.h"

namespace touchtrace::study {

/// All trackers on waved, thrown and bounced balls at two image sizes: what they lose, how far off
/// they are, and what they cost, with a picture of error over run time.
void measure_trackers(const std::function<void(Figure)>& emit, Progress& progress);
/// How often that advances `progress`: once a recording and tracker.
std::uint64_t tracker_trials();

}  // namespace touchtrace::study
