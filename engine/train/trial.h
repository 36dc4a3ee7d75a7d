#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// One of several ways to compute the same, to be timed beside the others.
struct Trial {
  std::function<void()> enqueue;
  double waiting;  ///< what cores without an item left add to the time, as a factor
};

/// With `waiting` from the launches of `enqueue`, `beside` of which run beside each other: the
/// mean, by their operations, of how much longer their items take than all cores would need: 8
/// items on 3 cores take as long as 9. 1 on what is no CPU, where time is by the wall.
Trial make_trial(Runtime& runtime, std::function<void()> enqueue, int beside);

/// Calls `make`; empty as well if the device refuses what it asks for, unless this is the `first`
/// trial.
std::optional<Trial> unless_refused(bool first, const std::function<std::optional<Trial>()>& make);

struct TrialTime {
  double ms, ratio;  ///< waiting included; the median of its ratio to the first trial's
};

/// Of each trial, measured in turns.
std::vector<TrialTime> compare(Runtime& runtime, const std::vector<Trial>& trials);

}  // namespace touchtrace
