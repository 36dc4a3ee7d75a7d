#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// What the inertial unit on the back of the hand tells during a clip: each sample is the mean over
/// the period before it, as a unit that filters before it samples gives it, with offsets of the
/// specimen, white noise and steps of 16 bits. Its orientation is its own estimate: the angular
/// velocity integrated, the vertical pulled slowly to that of the specific force (Mahony et al.,
/// IEEE TAC 2008); its heading starts anywhere and drifts.
InertialStream sense_inertia(const std::vector<SceneSample>& samples, const SceneOptions& options,
                             int clip);

}  // namespace touchtrace::scene
