#pragma once

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Separates an object from a hand of its colour while the two are apart. Connected components of
/// the hand's points become the object's if they have at least `min_points` (outstretched fingers
/// have fewer) and fit into a ball of 1.5 `radius_m`. The hand is the largest component near
/// `hand_m`.
void split_from_hand(Surface& surface, const Eigen::Vector3d& hand_m, double radius_m,
                     std::size_t min_points);

/// Makes connected components of the object's points that do not fit into a ball of 4 `radius_m`
/// the rest: a sleeve or a shirt of the object's colour, and an object that touches it.
void remove_large_components(Surface& surface, double radius_m);

}  // namespace touchtrace::label
