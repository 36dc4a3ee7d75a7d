#pragma once

#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/physics/contact_search.h"
#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;  ///< a twist; or a force and its torque

inline Vector6d joined(const Twist& twist) {
  Vector6d joint;
  joint << twist.linear, twist.angular;
  return joint;
}

/// The upper triangle of a sum of scale v v', row after row.
template <int size>
struct OuterSum {
  Lanes sums[size * (size + 1) / 2]{};

  void add(Lanes scale, const Lanes (&v)[size]) {
    for (int i = 0, k = 0; i < size; ++i)
      for (int j = i; j < size; ++j, ++k) sums[k] += scale * v[i] * v[j];
  }
  Eigen::Matrix<double, size, size> matrix() const {
    Eigen::Matrix<double, size, size> m;
    for (int i = 0, k = 0; i < size; ++i)
      for (int j = i; j < size; ++j, ++k) m(i, j) = m(j, i) = sum(sums[k]);
    return m;
  }
};

/// What the contacts of a rigid body do to it: force and torque are push - resistance twist.
class ContactSums {
 public:
  /// Contacts with the force push_n n + tangent_n - extra n n.v - isotropic v.
  void add(const Lanes3& place_m, const Lanes3& normal, Lanes push_n, const Lanes3& tangent_n,
           Lanes extra, Lanes isotropic) {
    const Lanes3 turn = cross(place_m, normal), twist = cross(place_m, tangent_n);
    along_.add(extra, {normal.x, normal.y, normal.z, turn.x, turn.y, turn.z});
    about_.add(isotropic, {place_m.x, place_m.y, place_m.z, all_lanes(1.0)});
    force_ += push_n * normal + tangent_n;
    torque_ += push_n * turn + twist;
  }
  Matrix6d resistance() const;
  Vector6d push() const;

 private:
  OuterSum<6> along_;  ///< of (n, p x n)
  OuterSum<4> about_;  ///< of (p, 1)
  Lanes3 force_{}, torque_{};
};

/// The hand feels them, the object the opposite.
void add_to_bodies(MotionSystem& system, const Matrix6d& resistance, const Vector6d& push);
void add_to_finger(MotionSystem& system, int finger, const Twist& with_flexion,
                   const Matrix6d& resistance, const Vector6d& push);

}  // namespace touchtrace::scene
