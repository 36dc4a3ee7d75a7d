#pragma once

#include <string>
#include <vector>

#include "engine/cl/launch.h"
#include "engine/model/touch_encoder.h"

namespace touchtrace {

/// One launch of an update.
struct PlannedLaunch {
  std::string kernel;
  Purpose purpose;
  LaunchCost cost;
  bool tuned;  ///< computed as touchtrace tune chose
};

/// The launches of an update in their order. They are those of a real one, on noise, which the
/// device does meanwhile; it is zero for taxels that are not live.
std::vector<PlannedLaunch> launches_of_update(Runtime& runtime, const ModelSpec& spec,
                                              int sequences, int steps, const LiveTaxels& live = {},
                                              const Tuning& tuning = {});

/// A launch, and what it takes of the device's time; that is processor seconds of all threads on a
/// CPU.
struct MeasuredLaunch {
  PlannedLaunch planned;
  double seconds;  ///< alone and again and again: caches hold what they can, nothing waits
  /// Where it stands in an update, but waited for: caches hold what the launch before left there,
  /// and threads are woken for it. With what is copied or filled before it.
  double seconds_in_place;
};

/// What an update takes. The sum of seconds_in_place differs from a whole update by what two queues
/// and waiting only once save.
struct MeasuredUpdate {
  std::vector<MeasuredLaunch> launches;  ///< in their order
  double peak_flops;                     ///< of fused multiply-adds, per second of device time
  double wall_seconds, cpu_seconds;      ///< of a whole update, as training does it
};

/// Runs launches, whole updates and the peak in turns and gives medians of at least seven. The
/// updates are those of launches_of_update() at a learning rate of 0: weights stay as they are
/// however often a launch runs. Progress on stderr.
MeasuredUpdate measure_update(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const LiveTaxels& live = {}, const Tuning& tuning = {});

}  // namespace touchtrace
