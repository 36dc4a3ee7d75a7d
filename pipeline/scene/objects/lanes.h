#pragma once

#include <Eigen/Core>
#include <cmath>

namespace touchtrace::scene {

/// SIMD vector of two doubles, the register width of every 64-bit processor. Contact sums use it
/// because Eigen's vectors of three doubles pass through memory.
using Lanes = double __attribute__((vector_size(16)));
using LaneMask = decltype(Lanes{} < Lanes{});
inline constexpr int num_lanes = 2;

inline Lanes broadcast(double value) { return Lanes{value, value}; }
inline Lanes load_lanes(const double* values) { return Lanes{values[0], values[1]}; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes sqrt(Lanes a) { return Lanes{std::sqrt(a[0]), std::sqrt(a[1])}; }
inline Lanes abs(Lanes a) { return max(a, -a); }
inline double sum(Lanes a) { return a[0] + a[1]; }
inline bool any(LaneMask a) { return (a[0] | a[1]) != 0; }

/// One 3-vector per lane.
struct Lanes3 {
  Lanes x, y, z;

  static Lanes3 all(const Eigen::Vector3d& v) {
    return {broadcast(v.x()), broadcast(v.y()), broadcast(v.z())};
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
inline Lanes norm(const Lanes3& a) { return sqrt(dot(a, a)); }
/// Component of `a` perpendicular to the unit vector.
inline Lanes3 perpendicular(const Lanes3& unit, const Lanes3& a) { return a - dot(unit, a) * unit; }
/// `a` where the mask is set, otherwise `b`.
inline Lanes3 select(LaneMask mask, const Lanes3& a, const Lanes3& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
template <class Matrix>
Lanes3 product(const Matrix& m, const Lanes3& a) {
  return {m(0, 0) * a.x + m(0, 1) * a.y + m(0, 2) * a.z,
          m(1, 0) * a.x + m(1, 1) * a.y + m(1, 2) * a.z,
          m(2, 0) * a.x + m(2, 1) * a.y + m(2, 2) * a.z};
}
inline Eigen::Vector3d sum(const Lanes3& a) { return {sum(a.x), sum(a.y), sum(a.z)}; }

}  // namespace touchtrace::scene
