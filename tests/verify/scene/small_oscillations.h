#pragma once

#include <complex>
#include <vector>

#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

/// Offsets of the coordinates: the object's position and rotation vector (world frame), flexions.
inline constexpr int small_place = 0, small_turn = 3, small_flexion = 6;
inline constexpr int small_count = small_flexion + num_fingers;
using SmallDisplacement = Eigen::Matrix<double, small_count, 1>;

/// Point where each taxel first touched the object, in the object's frame: the rest position of
/// friction's spring.
class FirstContacts {
 public:
  /// Assumes that all contacts have just begun.
  explicit FirstContacts(const World& world);
  /// Call after every step.
  void update(const World& world);
  const std::vector<Eigen::Vector3d>& point_m() const { return point_m_; }

 private:
  std::vector<Eigen::Vector3d> point_m_;
  std::vector<bool> touching_;
};

/// Theory of small oscillations of an object with flat faces in a hand that stands still:
/// M q'' + C q' + K q = 0 about the present state, with K the second derivatives of the energy of
/// taxel springs, fingers and gravity. Valid while no contact slips, ends or begins, for springs
/// that do not harden.
class SmallOscillations {
 public:
  SmallOscillations(const World& world, const FirstContacts& contacts, const Drive& drive,
                    const ContactParameters& contact);

  /// Undamped displacement `seconds` after a start at rest with `velocity`.
  SmallDisplacement free(const SmallDisplacement& velocity, double seconds) const;
  /// Complex displacement of the object relative to the hand over the hand's acceleration
  /// e^(i rate t) along `direction`.
  Eigen::Vector3cd response(const Eigen::Vector3d& direction, double rate_rad_per_s) const;

 private:
  Eigen::Matrix<double, small_count, small_count> mass_, damping_, stiffness_;
};

}  // namespace touchtrace::scene
