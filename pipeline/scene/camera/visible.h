#pragma once

#include "pipeline/scene/base/scene.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// Linear RGB in 0..1.
Eigen::Vector3d glove_color();

/// What a camera sees of the gloved hand, the forearm, the object and its ball at one instant, each
/// solid placed in the world (`body_from_shape` is then world_from_shape).
std::vector<Solid> hand_solids(const SceneSample& sample, const HandModel& hand = hand_model());
Solid forearm_solid(const SceneSample& sample);
std::vector<Solid> object_solids(const ObjectSpec& object, const SceneSample& sample);
std::vector<Solid> ball_solids(const ObjectSpec& object, const SceneSample& sample);
/// What is tracked of them: the ball if there is one, the part of the object that holds its tracked
/// point, or all of it where that is its middle.
std::vector<Solid> tracked_solids(const ObjectSpec& object, const SceneSample& sample);

}  // namespace touchtrace::scene
