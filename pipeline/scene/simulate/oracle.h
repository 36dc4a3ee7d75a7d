#pragma once

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Values of SceneOptions::sensed: "touch", "force", "acceleration".
std::vector<std::string> sensed_names();

/// Replaces the glove's frames by exact values of `options.sensed`, which show what a model could
/// reach with a perfect sensor; no-op for "touch". Each frame is the mean over the frame period
/// that ends with its scan, in the world frame: "force", of the hand on the object; "acceleration",
/// of object and hand. The image is a grid of areas of equal counts: a column for each axis, a row
/// for each sign of each vector; components are clipped at 100 N and 100 m/s^2. Times, lost frames
/// and jitter remain those of the glove.
void replace_touch(const SceneOptions& options, ClipMotion& motion);

}  // namespace touchtrace::scene
