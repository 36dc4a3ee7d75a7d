#pragma once

#include <optional>

#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {

/// What the hand's position may be told from, at one instant.
enum class Clue {
  readings,         ///< one tactile frame, less the baseline
  whether_touched,  ///< the object, at all
  phase,            ///< of a toss: the time from the nearest release or catch, in steps of 50 ms
  lean,             ///< of the object, and how fast it changes
  lean_and_push     ///< these and the force on the object, thus how the hand accelerates it
};

/// R^2 of a ridge regression from `clue` to the hand's position [x, y, z] in the middle of each
/// tactile frame's scan: every fourth clip is held out in turn. About 0 or less if the clue does
/// not tell the place. The best of three ridges for each axis, so that the probe does not fail by
/// fitting too closely. With `beyond`, of what a linear fit to that other clue leaves of both
/// position and clue: what the clue tells otherwise than through it.
Eigen::Vector3d position_probe_r2(const std::vector<ClipMotion>& clips, const GloveClock& clock,
                                  Clue clue = Clue::readings,
                                  std::optional<Clue> beyond = std::nullopt);

}  // namespace touchtrace::scene
