#pragma once

#include <functional>

#include "engine/base/figure.h"

namespace touchtrace::study {

/// All trackers on waved, thrown and bounced balls at two image sizes: what they lose, how far off
/// they are, and what they cost, with a picture of error over run time.
void measure_trackers(const std::function<void(Figure)>& emit);

}  // namespace touchtrace::study
