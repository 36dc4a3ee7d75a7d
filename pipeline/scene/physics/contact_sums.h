#pragma once

#include "pipeline/scene/objects/lanes.h"
#include "pipeline/scene/physics/contact_search.h"
#include "pipeline/scene/physics/motion_system.h"

namespace touchtrace::scene {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d =
    Eigen::Matrix<double, 6, 1>;  ///< twist (linear, angular) or wrench (force, torque)

inline Vector6d stack(const Twist& twist) {
  Vector6d vector;
  vector << twist.linear, twist.angular;
  return vector;
}

/// Sum of scale v v': upper triangle, row by row.
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

/// Wrench of the contacts of one rigid link as a linear function of its twist:
/// bias() - resistance() twist.
class ContactSums {
 public:
  /// Adds contacts with the force push_n n + tangent_n - extra n n.v - isotropic v.
  void add(const Lanes3& point_m, const Lanes3& normal, Lanes push_n, const Lanes3& tangent_n,
           Lanes extra, Lanes isotropic) {
    const Lanes3 normal_moment = cross(point_m, normal), tangent_moment = cross(point_m, tangent_n);
    normal_sum_.add(
        extra, {normal.x, normal.y, normal.z, normal_moment.x, normal_moment.y, normal_moment.z});
    isotropic_sum_.add(isotropic, {point_m.x, point_m.y, point_m.z, broadcast(1.0)});
    force_ += push_n * normal + tangent_n;
    torque_ += push_n * normal_moment + tangent_moment;
  }
  Matrix6d resistance() const;
  Vector6d bias() const;

 private:
  OuterSum<6> normal_sum_;     ///< of (n, p x n)
  OuterSum<4> isotropic_sum_;  ///< of (p, 1)
  Lanes3 force_{}, torque_{};
};

/// Adds a wrench on the hand, and the opposite one on the object, to the system.
void add_to_bodies(MotionSystem& system, const Matrix6d& resistance, const Vector6d& bias);
/// Adds the projection of a link's wrench on the flexion of its finger.
void add_to_finger(MotionSystem& system, int finger, const Twist& flexion_twist,
                   const Matrix6d& resistance, const Vector6d& bias);

}  // namespace touchtrace::scene
