#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Physics, glove and its clock for clip number `clip`, starting at `start_s`; depends on nothing
/// but its arguments, so clips may be simulated in any order on any number of threads.
ClipMotion simulate_clip(const SceneOptions& options, int clip, double start_s);

}  // namespace touchtrace::scene
