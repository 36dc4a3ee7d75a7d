#pragma once

#include <string>
#include <vector>

#include "engine/cl/launch.h"
#include "engine/model/touch_encoder.h"

namespace touchtrace {

/// One launch of an update.
struct PlannedLaunch {
  std::string kernel;
  LaunchCost cost;
  bool tuned;  ///< computed as touchtrace tune chose
};

/// The launches of an update in their order. They are those of a real one, on noise, which the
/// device does meanwhile; it is zero for taxels that are not live.
std::vector<PlannedLaunch> launches_of_update(Runtime& runtime, const ModelSpec& spec,
                                              int sequences, int steps, const LiveTaxels& live = {},
                                              const Tuning& tuning = {});

}  // namespace touchtrace
