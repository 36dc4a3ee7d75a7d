#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace touchtrace {

/// Lens models. A lens L projects a camera-frame point p in three steps:
///     m = L::normalize(p)          ideal projection, without units
///     d = L::distort(k, m)         distortion with the coefficients k
///     pixel = (fx d.x + cx, fy d.y + cy)
/// L::can_project(p): the domain of normalize(). L::direction(m): the inverse of normalize(), a
/// vector of any length, NaN outside of its range.
///
/// To add a lens, write a struct like those below, derived from its ideal projection, with `name`,
/// `coefficients`, `interop` and distort(), and append it to `Lens`, after all simpler ones. The
/// calibration, the choice of the lens, files and tests then include it. distort() must be the
/// identity at the centre and for k = 0, and must accept any Ceres scalar. A coefficient that
/// another lens of the same ideal projection has must have the same index there
/// (calib/rgbd/color_fit.cpp reuses fits).

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Perspective projection (X/Z, Y/Z), Z > 0.
struct Perspective {
  template <class T>
  static bool can_project(const Vector3<T>& p) {
    return p.z() > T(0);
  }
  template <class T>
  static Vector2<T> normalize(const Vector3<T>& p) {
    return {p.x() / p.z(), p.y() / p.z()};
  }
  static Eigen::Vector3d direction(const Eigen::Vector2d& m) { return {m.x(), m.y(), 1.0}; }
};

/// Equidistant projection: the angle to the optical axis [rad] in the direction of (X, Y). Its
/// domain is everything except the negative optical axis.
struct Equidistant {
  template <class T>
  static bool can_project(const Vector3<T>& p) {
    return p.z() > T(0) || p.x() * p.x() + p.y() * p.y() > T(0);
  }
  template <class T>
  static Vector2<T> normalize(const Vector3<T>& p) {
    using std::atan2, std::sqrt;
    const T square = p.x() * p.x() + p.y() * p.y();
    const T tangent2 = square / (p.z() * p.z());
    constexpr double series_below = 1e-8;  // there atan(t) / t = 1 - t^2/3 to double precision
    if (p.z() > T(0) && tangent2 < T(series_below)) {
      const T scale = (T(1) - tangent2 / T(3)) / p.z();
      return {p.x() * scale, p.y() * scale};
    }
    const T radius = sqrt(square);
    const T scale = atan2(radius, p.z()) / radius;
    return {p.x() * scale, p.y() * scale};
  }
  static Eigen::Vector3d direction(const Eigen::Vector2d& m);
};

/// Names of a lens in other programs.
struct LensInterop {
  const char* ros;           ///< distortion_model of camera_info
  int num_ros_coefficients;  ///< also OpenCV's: the lens's coefficients, then zeros
  const char* kalibr;        ///< distortion_model with four coefficients; nullptr: no equivalent
};

namespace detail {

/// Tangential (decentring) distortion with OpenCV's p1 and p2; r2 = |m|^2.
template <class T>
Vector2<T> tangential(const T& p1, const T& p2, const Vector2<T>& m, const T& r2) {
  const T xy2 = T(2) * m.x() * m.y();
  return {p1 * xy2 + p2 * (r2 + T(2) * m.x() * m.x()), p1 * (r2 + T(2) * m.y() * m.y()) + p2 * xy2};
}

}  // namespace detail

/// No distortion, as in a rectified image.
struct Undistorted : Perspective {
  static constexpr const char* name = "none";
  static constexpr std::array<const char*, 0> coefficients{};
  static constexpr LensInterop interop{"plumb_bob", 5, "radtan"};
  template <class T>
  static Vector2<T> distort(const T*, const Vector2<T>& m) {
    return m;
  }
};

/// Brown's radial-tangential distortion as OpenCV defines it, radial factor 1 + k1 r^2 + k2 r^4.
struct Radtan4 : Perspective {
  static constexpr const char* name = "radtan4";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2"};
  static constexpr LensInterop interop{"plumb_bob", 5, "radtan"};
  template <class T>
  static Vector2<T> distort(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    return m * (T(1) + r2 * (k[0] + r2 * k[1])) + detail::tangential(k[2], k[3], m, r2);
  }
};

/// Radtan4 with k3 r^6 added to the radial factor.
struct Radtan5 : Perspective {
  static constexpr const char* name = "radtan5";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2", "k3"};
  static constexpr LensInterop interop{"plumb_bob", 5, nullptr};
  template <class T>
  static Vector2<T> distort(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    return m * (T(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) +
           detail::tangential(k[2], k[3], m, r2);
  }
};

/// Radtan5 with the radial factor divided by 1 + k4 r^2 + k5 r^4 + k6 r^6 (OpenCV's
/// CALIB_RATIONAL_MODEL).
struct Rational8 : Perspective {
  static constexpr const char* name = "rational8";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static constexpr LensInterop interop{"rational_polynomial", 8, nullptr};
  template <class T>
  static Vector2<T> distort(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    const T numerator = T(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const T denominator = T(1) + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
    return m * (numerator / denominator) + detail::tangential(k[2], k[3], m, r2);
  }
};

/// Fisheye of Kannala and Brandt (PAMI 2006), OpenCV's fisheye, kalibr's equidistant: the angle a
/// times 1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8.
struct Fisheye4 : Equidistant {
  static constexpr const char* name = "fisheye4";
  static constexpr std::array coefficients{"k1", "k2", "k3", "k4"};
  static constexpr LensInterop interop{"equidistant", 4, "equidistant"};
  template <class T>
  static Vector2<T> distort(const T* k, const Vector2<T>& m) {
    const T a2 = m.squaredNorm();
    return m * (T(1) + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
  }
};

using Lens = std::variant<Undistorted, Radtan4, Radtan5, Rational8, Fisheye4>;

inline constexpr int max_coefficients = 8, max_intrinsics = 4 + max_coefficients;

/// Projects a camera-frame point [m], for which L::can_project() holds, to a pixel. `intrinsics`:
/// fx fy cx cy, then L::coefficients. T: double or a Ceres Jet.
template <class L, class T>
Vector2<T> project_point(const T* intrinsics, const Vector3<T>& p) {
  const Vector2<T> m = L::distort(intrinsics + 4, L::normalize(p));
  return {intrinsics[0] * m.x() + intrinsics[2], intrinsics[1] * m.y() + intrinsics[3]};
}

/// The same for any lens; NaN where it cannot project.
Eigen::Vector2d project_point(const Lens& lens, const double* intrinsics, const Eigen::Vector3d& p);

/// Calls `use` with the lens as its own type.
template <class Use>
decltype(auto) with_lens(const Lens& lens, Use&& use) {
  return std::visit(std::forward<Use>(use), lens);
}

std::string lens_name(const Lens& lens);
std::vector<std::string> coefficient_names(const Lens& lens);
std::vector<std::string> intrinsic_names(const Lens& lens);  ///< fx fy cx cy, then coefficients
int num_intrinsics(const Lens& lens);
std::vector<Lens> all_lenses();                          ///< in the order of `Lens`
std::optional<Lens> find_lens(const std::string& name);  ///< nullopt for an unknown name
LensInterop lens_interop(const Lens& lens);
bool is_perspective(const Lens& lens);  ///< false: fisheye

}  // namespace touchtrace
