#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// One variant of a computation, to be timed against others.
struct Trial {
  std::function<void()> enqueue;
  double idle_factor;  ///< >= 1, multiplies the time: accounts for idle cores
};

/// Makes a trial. `concurrency`: number of launches that run at the same time.
///
/// The idle factor follows from the launches of `enqueue`: the mean, weighted by operations, of how
/// much longer their work-items take than perfectly balanced cores would; 8 items on 3 cores take
/// as long as 9. It is 1 on other devices than CPUs, where wall time is measured.
Trial make_trial(Runtime& runtime, std::function<void()> enqueue, int concurrency);

/// Calls `make`. Returns nullopt if the device rejects the variant, unless it is the first one:
/// then rethrows.
std::optional<Trial> make_if_supported(bool is_first,
                                       const std::function<std::optional<Trial>()>& make);

/// Times include the idle factor.
struct TrialTime {
  double ms;     ///< median
  double ratio;  ///< median ratio to the first trial
};

/// Measures all trials, interleaved.
std::vector<TrialTime> compare(Runtime& runtime, const std::vector<Trial>& trials);

}  // namespace touchtrace
