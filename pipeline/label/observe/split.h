#pragma once

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Separates an object from a hand of its colour while the two are apart. Connected components of
/// the hand's points become the object's if they have at least `min_points` (outstretched fingers
/// have fewer) and fit into a ball of 1.5 `radius_m`. The hand is the largest component near
/// `hand_m`.
void split_from_hand(Surface& surface, const Eigen::Vector3d& hand_m, double radius_m,
                     std::size_t min_points);

}  // namespace touchtrace::label
