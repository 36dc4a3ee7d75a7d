#pragma once

#include <span>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

inline constexpr int glove_rows = 32, glove_cols = 32;
inline constexpr int max_links = 3;
inline constexpr double max_flexion_rad = 1.6;

/// Kinematic chain whose joints all rotate by multiples of one flexion angle, about the -y axis of
/// the base frame: x along the stretched finger, z out of its palmar side.
struct Finger {
  Eigen::Vector3d base_m;  ///< first joint, hand's frame
  Eigen::Matrix3d hand_from_base;
  int links;
  std::array<double, max_links> length_m, coupling;  ///< coupling: joint angle over flexion
  double radius_m;
};

/// A sensing element fixed to a link.
struct Taxel {
  int finger, link;            ///< finger -1: the palm
  Eigen::Vector3d position_m;  ///< frame of its link; the hand's frame for the palm
  double area_m2;
  int row, col;  ///< in the tactile image

  int cell() const { return row * glove_cols + col; }
};

/// Neighbouring taxels of one link with a bounding sphere, for the broad phase.
struct TaxelGroup {
  int finger, link;
  int first, count;
  Eigen::Vector3d centre_m;
  double radius_m;
};

struct HandModel {
  std::array<Finger, num_fingers> fingers;
  std::vector<Taxel> taxels;  ///< group by group
  std::vector<TaxelGroup> groups;
};

/// Right hand of average size: 224 taxels on the palm, a shallow dish, 4 x 90 on the fingers and 96
/// on the thumb. One cached instance per shape, never destroyed. Thread-safe.
const HandModel& hand_model(const HandParameters& shape = {});

/// Poses of the links of one finger in the hand's frame.
struct FingerPose {
  std::array<Eigen::Matrix3d, max_links> hand_from_link;
  std::array<Eigen::Vector3d, max_links> joint_m;
  Eigen::Vector3d axis;  ///< of all joints
};
FingerPose pose_finger(const Finger& finger, double flexion_rad);

}  // namespace touchtrace::scene
