#pragma once

#include <Eigen/Core>

#include "pipeline/label/observe/lift.h"

namespace touchtrace::label {

/// One body in one camera frame.
struct Observation {
  bool found = false;
  bool follows_hand = false;  ///< the object is not visible: position assumed from the hand's
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(),
                  sigma_m = Eigen::Vector3d::Zero();  ///< of the body's centre, per axis
  PixelBox box;
};

inline constexpr double hand_sigma_m = 0.004;

Observation observe_hand(const Patch& patch);

/// Whether a hand goes on into an arm of its colour, so that its place along the arm is unknown.
bool is_on_arm(const Patch& hand, const Surface& surface);

/// Object that is not visible and moves with the hand.
Observation hidden_object_at(const Eigen::Vector3d& position_m);

/// Standard deviations of a body's centre along the axes. `information`: of the centre for points
/// of variance 1 m^2. `visible`: visible fraction of its disc. `point_sigma`: of a point.
Eigen::Vector3d position_sigma(const Eigen::Matrix3d& information, double visible,
                               double point_sigma);

}  // namespace touchtrace::label
