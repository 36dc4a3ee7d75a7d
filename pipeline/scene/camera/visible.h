#pragma once

#include "pipeline/scene/base/scene.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// Linear RGB in 0..1.
Eigen::Vector3d glove_color();

// Visible solids of one instant, placed in the world: `body_from_shape` is world_from_shape.

std::vector<Solid> hand_solids(const SceneSample& sample, const HandModel& hand = hand_model());
Solid forearm_solid(const SceneSample& sample);
std::vector<Solid> object_solids(const ObjectSpec& object, const SceneSample& sample);
std::vector<Solid> ball_solids(const ObjectSpec& object, const SceneSample& sample);
/// The solids of the tracked target: the ball if there is one, otherwise the object's solids that
/// contain its tracked point, or all of them if that is its centre of mass.
std::vector<Solid> tracked_solids(const ObjectSpec& object, const SceneSample& sample);

}  // namespace touchtrace::scene
