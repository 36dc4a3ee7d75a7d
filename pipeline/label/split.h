#pragma once

#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// Tells an object from a hand of its colour while they are apart: points of the hand that hang
/// together beside the hand, no farther from each other than an object of `radius_m` and `fewest`
/// at least, become the object's; fingers that stick out are fewer. The hand is the most that hangs
/// together near `hand_m`.
void split_from_hand(Surface& surface, const Eigen::Vector3d& hand_m, double radius_m,
                     std::size_t fewest);

}  // namespace touchtrace::label
