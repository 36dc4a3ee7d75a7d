#pragma once

#include <span>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

inline constexpr int glove_rows = 32, glove_cols = 32;
inline constexpr int max_links = 3;
inline constexpr double max_flexion_rad = 1.6;

/// A chain of links that all flex by multiples of one angle, about the -y axis of the chain's base
/// frame: x runs along the stretched finger, z out of its palmar side.
struct Finger {
  Eigen::Vector3d base_m;  ///< of the first joint, hand's frame
  Eigen::Matrix3d hand_from_base;
  int links;
  std::array<double, max_links> length_m, coupling;  ///< of each joint's angle to the first's
  double radius_m;
};

/// A sensing element, fixed to a link (`finger` -1: the palm), at (row, col) of the tactile image.
struct Taxel {
  int finger, link;
  Eigen::Vector3d position_m;  ///< frame of its link; of the hand for the palm
  double area_m2;
  int row, col;

  int cell() const { return row * glove_cols + col; }
};

/// Neighbouring taxels of one link and a sphere around them, so that most need not be looked at.
struct TaxelGroup {
  int finger, link;
  int first, count;
  Eigen::Vector3d centre_m;
  double radius_m;
};

struct HandModel {
  std::array<Finger, finger_count> fingers;
  std::vector<Taxel> taxels;  ///< group after group
  std::vector<TaxelGroup> groups;
};

/// Palm 224 taxels on a shallow dish, fingers 4 x 90, thumb 96. A right hand of average size. Of
/// every shape there is one, which lasts.
const HandModel& hand_model(const HandParameters& shape = {});

/// Where the links of one finger are at a flexion, in the hand's frame.
struct FingerPose {
  std::array<Eigen::Matrix3d, max_links> hand_from_link;
  std::array<Eigen::Vector3d, max_links> joint_m;
  Eigen::Vector3d axis;

  /// How a point of link `link` moves with the flexion [m/rad]; everything in the hand's frame.
  Eigen::Vector3d jacobian(const Finger& finger, int link, const Eigen::Vector3d& point) const;
};
FingerPose pose_finger(const Finger& finger, double flexion_rad);

}  // namespace touchtrace::scene
