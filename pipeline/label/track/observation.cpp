#include "pipeline/label/track/observation.h"

#include <Eigen/LU>
#include <cmath>

namespace touchtrace::label {
namespace {

constexpr double hidden_sigma_m =
    0.005;  // of a hidden object from frame to frame, for the smoother
// Points err more where the colours of two bodies mix, at a patch's edge. The smaller the visible
// part, the larger the share of the edge.
constexpr double edge_fraction = 0.25;
// Points of the hand's class beyond the hand, up to so many of its radii, over those within: more
// are an arm's. In public recordings .34 (median) along a bare arm, up to .05 in fourteen others.
constexpr double max_arm_radii = 1.5, max_arm_ratio = 0.2;
constexpr double min_position_sigma_m = 0.0003, max_position_sigma_m = 0.03;

}  // namespace

Eigen::Vector3d position_sigma(const Eigen::Matrix3d& information, double visible,
                               double point_sigma) {
  const double point_m2 = point_sigma * point_sigma * (1.0 + edge_fraction / visible);
  const Eigen::Matrix3d prior =
      Eigen::Matrix3d::Identity() * point_m2 / (max_position_sigma_m * max_position_sigma_m);
  const Eigen::Vector3d variance = (information + prior).inverse().diagonal();
  return (variance.array() * point_m2 + min_position_sigma_m * min_position_sigma_m).sqrt();
}

Observation observe_hand(const Patch& patch) {
  return {
      true, false, patch.centroid_m, {hand_sigma_m, hand_sigma_m, 1.5 * hand_sigma_m}, patch.box};
}

bool is_on_arm(const Patch& hand, const Surface& surface) {
  int on_hand = 0, beyond = 0;
  for (const auto& point : surface) {
    if (point.body != Body::hand) continue;
    const double radii =
        (point.position_m.cast<double>() - hand.centroid_m).norm() / hand_patch_radius_m;
    on_hand += radii < 1.0, beyond += radii >= 1.0 && radii < max_arm_radii;
  }
  return beyond > max_arm_ratio * on_hand;
}

Observation hidden_object_at(const Eigen::Vector3d& position_m) {
  Observation object;
  object.found = object.follows_hand = true;
  object.position_m = position_m;
  object.sigma_m.setConstant(hidden_sigma_m);
  return object;
}

}  // namespace touchtrace::label
