#pragma once

#include <Eigen/Core>
#include <vector>

namespace touchtrace::label {

/// Offset of the object from the hand [m, colour camera's frame]: median over the last frames that
/// showed both, which ignores the few frames in which the object leaves the hand.
class Grip {
 public:
  /// Adds a frame that shows object and hand.
  void add(const Eigen::Vector3d& object_from_hand_m);
  /// Median by axis. Requires at least one frame.
  Eigen::Vector3d object_from_hand_m() const;
  /// Distance of object and hand in the first frame.
  double initial_distance_m() const { return initial_distance_m_; }

 private:
  std::vector<Eigen::Vector3d> last_;
  double initial_distance_m_ = 0.0;
};

}  // namespace touchtrace::label
