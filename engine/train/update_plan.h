#pragma once

#include <string>
#include <vector>

#include "engine/cl/launch.h"
#include "engine/model/conv_stack_shape.h"
#include "engine/model/model_spec.h"

namespace touchtrace {

/// One launch of a training update.
struct PlannedLaunch {
  std::string kernel;
  Purpose purpose;
  LaunchCost cost;
};

/// Launches of an update, in order. Runs a real update on random data to record them; the data are
/// zero for taxels that are not live.
std::vector<PlannedLaunch> launches_of_update(Runtime& runtime, const ModelSpec& spec,
                                              int sequences, int steps,
                                              const LiveTaxels& live = {});

/// A launch and its device time; on a CPU, CPU seconds of all threads.
struct MeasuredLaunch {
  PlannedLaunch planned;
  double seconds;  ///< launched repeatedly: warm caches, no waiting
  /// At its place in an update, but waited for: caches hold what the launch before left there, and
  /// threads are woken for it. Includes copies and fills before it.
  double seconds_in_place;
};

/// Cost of an update. The sum of seconds_in_place differs from a whole update by what two queues
/// and waiting only once save.
struct MeasuredUpdate {
  std::vector<MeasuredLaunch> launches;  ///< in order
  double peak_flops;                     ///< of fused multiply-adds, per second of device time
  double wall_seconds, cpu_seconds;      ///< of a whole update, as in training
};

/// Measures launches, whole updates and the multiply-add peak, interleaved; medians of at least 7.
/// The updates are those of launches_of_update() with a learning rate of 0, so that the weights
/// stay however often a launch runs. Shows progress on stderr.
MeasuredUpdate measure_update(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const LiveTaxels& live = {});

}  // namespace touchtrace
