#pragma once

#include <optional>

#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {

/// Input of the probe at one instant.
enum class ProbeInput {
  readings,       ///< one tactile frame minus the baseline
  contact,        ///< whether the hand touches the object
  phase,          ///< of a toss: time from the nearest release or catch, in steps of 50 ms
  lean,           ///< of the object, and its rate
  lean_and_force  ///< these and the force on the object, which shows the hand's acceleration
};

/// R^2 of a ridge regression from `input` to the hand's position [x, y, z] in the middle of each
/// tactile frame's scan, by 4-fold cross-validation over clips. Near 0 or negative if the input is
/// not informative. The best of three ridge parameters per axis, so that the probe does not fail by
/// overfitting. With `given`, both position and input are first replaced by their residuals of a
/// linear fit to `given`: the result is what the input tells beyond it.
Eigen::Vector3d position_probe_r2(const std::vector<ClipMotion>& clips, const GloveClock& clock,
                                  ProbeInput input = ProbeInput::readings,
                                  std::optional<ProbeInput> given = std::nullopt);

}  // namespace touchtrace::scene
