#pragma once

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// Tells an object from a hand of its colour while they are apart: the hand's points that hang
/// together beside the hand, and no farther from each other than an object of `radius_m`, become
/// the object's. The hand is what hangs together nearest to `hand_m`.
void split_from_hand(Surface& surface, const Eigen::Vector3d& hand_m, double radius_m);

}  // namespace touchtrace::label
