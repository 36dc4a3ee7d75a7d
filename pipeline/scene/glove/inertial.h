#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Readings of the inertial unit on the back of the hand in a clip. Each sample is the mean over
/// the period before it, as of a unit that filters before sampling, with the instance's offsets,
/// white noise and 16-bit quantisation. The orientation is the unit's own estimate: the integrated
/// angular velocity, with the vertical slowly corrected to the specific force (Mahony et al., IEEE
/// TAC 2008); its heading has a random origin and drifts.
InertialStream sense_inertia(const std::vector<SceneSample>& samples, const SceneOptions& options,
                             int clip);

}  // namespace touchtrace::scene
