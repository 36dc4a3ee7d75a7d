#pragma once

#include <complex>
#include <vector>

#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

/// Order of the coordinates: the object's place and turn (world), the flexions.
inline constexpr int small_place = 0, small_turn = 3, small_flexion = 6;
inline constexpr int small_count = small_flexion + finger_count;
using SmallMotion = Eigen::Matrix<double, small_count, 1>;

/// Where each taxel first touched, as the object sees it: there friction's spring is at rest.
class Touches {
 public:
  /// As if everything in contact had come there just now.
  explicit Touches(const World& world);
  /// To be called after every step.
  void follow(const World& world);
  const std::vector<Eigen::Vector3d>& place_m() const { return place_m_; }

 private:
  std::vector<Eigen::Vector3d> place_m_;
  std::vector<bool> touching_;
};

/// Small motions, about where it is now, of an object with flat faces in a hand that stands still:
/// M q'' + C q' + K q = 0 with K the second derivatives of the energy of springs under the taxels,
/// fingers and gravity. Holds while nothing slips, parts or newly touches, and for springs that do
/// not harden.
class SmallMotions {
 public:
  SmallMotions(const World& world, const Touches& touches, const Drive& drive,
               const ContactParameters& contact);

  /// From rest with `velocity`, `seconds` later and without damping: sin or sinh of every mode.
  SmallMotion free(const SmallMotion& velocity, double seconds) const;
  /// How the object moves against the hand while the hand moves with acceleration e^(i rate t)
  /// along `direction`, over that acceleration.
  Eigen::Vector3cd shaken(const Eigen::Vector3d& direction, double rate_rad_per_s) const;

 private:
  Eigen::Matrix<double, small_count, small_count> mass_, damping_, stiffness_;
};

}  // namespace touchtrace::scene
