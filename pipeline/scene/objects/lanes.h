#pragma once

#include <Eigen/Core>
#include <cmath>

namespace touchtrace::scene {

/// Two numbers that are computed with at once: the width of the registers that every 64-bit
/// processor has. Eigen's vectors of three pass through memory instead.
using Lanes = double __attribute__((vector_size(16)));
using LaneMask = decltype(Lanes{} < Lanes{});
inline constexpr int lane_count = 2;

inline Lanes all_lanes(double value) { return Lanes{value, value}; }
inline Lanes lanes_of(const double* values) { return Lanes{values[0], values[1]}; }
inline Lanes largest(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes smallest(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes root(Lanes a) { return Lanes{std::sqrt(a[0]), std::sqrt(a[1])}; }
inline Lanes absolute(Lanes a) { return largest(a, -a); }
inline double sum(Lanes a) { return a[0] + a[1]; }
inline bool any(LaneMask a) { return (a[0] | a[1]) != 0; }

struct Lanes3 {
  Lanes x, y, z;

  static Lanes3 all(const Eigen::Vector3d& v) {
    return {all_lanes(v.x()), all_lanes(v.y()), all_lanes(v.z())};
  }
  void set(int lane, const Eigen::Vector3d& v) {
    x[lane] = v.x(), y[lane] = v.y(), z[lane] = v.z();
  }
  Eigen::Vector3d at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  Lanes3& operator+=(const Lanes3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
};

inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes3 operator*(Lanes s, const Lanes3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Lanes norm(const Lanes3& a) { return root(dot(a, a)); }
/// What of `a` is across the unit vector.
inline Lanes3 across(const Lanes3& unit, const Lanes3& a) { return a - dot(unit, a) * unit; }
inline Lanes3 choose(LaneMask first, const Lanes3& a, const Lanes3& b) {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z};
}
template <class Matrix>
Lanes3 product(const Matrix& m, const Lanes3& a) {
  return {m(0, 0) * a.x + m(0, 1) * a.y + m(0, 2) * a.z,
          m(1, 0) * a.x + m(1, 1) * a.y + m(1, 2) * a.z,
          m(2, 0) * a.x + m(2, 1) * a.y + m(2, 2) * a.z};
}
inline Eigen::Vector3d sum(const Lanes3& a) { return {sum(a.x), sum(a.y), sum(a.z)}; }

}  // namespace touchtrace::scene
