#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace touchtrace {

/// How a camera sees, in two steps. `spread` takes a point of the camera's frame to the plane of an
/// ideal lens, `bend` moves it there by the distortion; the pixel is (fx, fy) times that plus (cx,
/// cy). `ray` inverts `spread` to (X/Z, Y/Z, 1).
///
/// To add a lens, write a struct like those below and name it in `Lens`.

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// (X/Z, Y/Z): everything before the camera.
struct Perspective {
  template <class T>
  static bool sees(const Vector3<T>& p) {
    return p.z() > T(0);
  }
  template <class T>
  static Vector2<T> spread(const Vector3<T>& p) {
    return {p.x() / p.z(), p.y() / p.z()};
  }
  static Eigen::Vector3d ray(const Eigen::Vector2d& m) { return {m.x(), m.y(), 1.0}; }
};

/// The angle to the optical axis [rad] in the point's direction: everything but what lies straight
/// behind. `ray` is not a number from 90 degrees on.
struct Equidistant {
  template <class T>
  static bool sees(const Vector3<T>& p) {
    return p.z() > T(0) || p.x() * p.x() + p.y() * p.y() > T(0);
  }
  template <class T>
  static Vector2<T> spread(const Vector3<T>& p) {
    using std::atan2, std::sqrt;
    const T square = p.x() * p.x() + p.y() * p.y();
    const T tangent2 = square / (p.z() * p.z());
    constexpr double series_below = 1e-8;  // where atan(t) / t = 1 - t^2/3 to double precision
    if (p.z() > T(0) && tangent2 < T(series_below)) {
      const T scale = (T(1) - tangent2 / T(3)) / p.z();
      return {p.x() * scale, p.y() * scale};
    }
    const T radius = sqrt(square);
    const T scale = atan2(radius, p.z()) / radius;
    return {p.x() * scale, p.y() * scale};
  }
  static Eigen::Vector3d ray(const Eigen::Vector2d& m);
};

/// What other programs call a lens. ROS and OpenCV write `coefficients`, the lens's own and zeros;
/// kalibr four.
struct ForeignLens {
  const char* ros;
  int coefficients;
  const char* kalibr;  ///< nullptr if it has none such
};

namespace detail {

/// OpenCV's p1 and p2: the lens's parts are not centred on one another.
template <class T>
Vector2<T> tangential(const T& p1, const T& p2, const Vector2<T>& m, const T& r2) {
  const T xy2 = T(2) * m.x() * m.y();
  return {p1 * xy2 + p2 * (r2 + T(2) * m.x() * m.x()), p1 * (r2 + T(2) * m.y() * m.y()) + p2 * xy2};
}

}  // namespace detail

/// What an image has once it is rectified.
struct Undistorted : Perspective {
  static constexpr const char* name = "none";
  static constexpr std::array<const char*, 0> coefficients{};
  static constexpr ForeignLens foreign{"plumb_bob", 5, "radtan"};
  template <class T>
  static Vector2<T> bend(const T*, const Vector2<T>& m) {
    return m;
  }
};

/// Brown's radial-tangential distortion as OpenCV defines it: 1 + k1 r^2 + k2 r^4.
struct Radtan4 : Perspective {
  static constexpr const char* name = "radtan4";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2"};
  static constexpr ForeignLens foreign{"plumb_bob", 5, "radtan"};
  template <class T>
  static Vector2<T> bend(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    return m * (T(1) + r2 * (k[0] + r2 * k[1])) + detail::tangential(k[2], k[3], m, r2);
  }
};

/// With k3 r^6.
struct Radtan5 : Perspective {
  static constexpr const char* name = "radtan5";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2", "k3"};
  static constexpr ForeignLens foreign{"plumb_bob", 5, nullptr};
  template <class T>
  static Vector2<T> bend(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    return m * (T(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) +
           detail::tangential(k[2], k[3], m, r2);
  }
};

/// That over 1 + k4 r^2 + k5 r^4 + k6 r^6 (OpenCV's CALIB_RATIONAL_MODEL).
struct Rational8 : Perspective {
  static constexpr const char* name = "rational8";
  static constexpr std::array coefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static constexpr ForeignLens foreign{"rational_polynomial", 8, nullptr};
  template <class T>
  static Vector2<T> bend(const T* k, const Vector2<T>& m) {
    const T r2 = m.squaredNorm();
    const T above = T(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const T below = T(1) + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
    return m * (above / below) + detail::tangential(k[2], k[3], m, r2);
  }
};

/// Kannala and Brandt (PAMI 2006), OpenCV's fisheye, kalibr's equidistant: the angle times
/// 1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8.
struct Fisheye4 : Equidistant {
  static constexpr const char* name = "fisheye4";
  static constexpr std::array coefficients{"k1", "k2", "k3", "k4"};
  static constexpr ForeignLens foreign{"equidistant", 4, "equidistant"};
  template <class T>
  static Vector2<T> bend(const T* k, const Vector2<T>& m) {
    const T a2 = m.squaredNorm();
    return m * (T(1) + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
  }
};

using Lens = std::variant<Undistorted, Radtan4, Radtan5, Rational8, Fisheye4>;

inline constexpr int max_coefficients = 8, max_intrinsics = 4 + max_coefficients;

/// The pixel of a point [m] in the camera's frame that L::sees, for any scalar, so that Ceres
/// differentiates it. `intrinsics`: fx fy cx cy, then L::coefficients.
template <class L, class T>
Vector2<T> project_point(const T* intrinsics, const Vector3<T>& p) {
  const Vector2<T> m = L::bend(intrinsics + 4, L::spread(p));
  return {intrinsics[0] * m.x() + intrinsics[2], intrinsics[1] * m.y() + intrinsics[3]};
}

/// Calls `use` with the lens as its own type.
template <class Use>
decltype(auto) with_lens(const Lens& lens, Use&& use) {
  return std::visit(std::forward<Use>(use), lens);
}

std::string lens_name(const Lens& lens);
std::vector<std::string> coefficient_names(const Lens& lens);
std::vector<std::string> intrinsic_names(const Lens& lens);  ///< fx fy cx cy before them
std::vector<Lens> all_lenses();
/// Nothing if no lens is called that.
std::optional<Lens> lens_of(const std::string& name);
ForeignLens foreign_lens(const Lens& lens);
bool is_perspective(const Lens& lens);  ///< else it is a fisheye

}  // namespace touchtrace
