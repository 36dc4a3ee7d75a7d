#include "calib/camera/lens.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

namespace touchtrace {

Eigen::Vector3d Equidistant::direction(const Eigen::Vector2d& m) {
  const double angle = m.norm();
  if (!(angle < std::numbers::pi))
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const double scale = angle > 0.0 ? std::sin(angle) / angle : 1.0;
  return {scale * m.x(), scale * m.y(), std::cos(angle)};
}

Eigen::Vector2d project_point(const Lens& lens, const double* intrinsics,
                              const Eigen::Vector3d& p) {
  return with_lens(lens, [&](auto l) -> Eigen::Vector2d {
    if (!l.can_project(p))
      return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    return project_point<decltype(l)>(intrinsics, p);
  });
}

std::string lens_name(const Lens& lens) {
  return with_lens(lens, [](auto l) { return l.name; });
}

std::vector<std::string> coefficient_names(const Lens& lens) {
  return with_lens(lens, [](auto l) {
    return std::vector<std::string>(l.coefficients.begin(), l.coefficients.end());
  });
}

std::vector<std::string> intrinsic_names(const Lens& lens) {
  std::vector<std::string> names{"fx", "fy", "cx", "cy"};
  std::ranges::copy(coefficient_names(lens), std::back_inserter(names));
  return names;
}

int num_intrinsics(const Lens& lens) {
  return 4 + with_lens(lens, [](auto l) { return static_cast<int>(l.coefficients.size()); });
}

std::vector<Lens> all_lenses() {
  return []<std::size_t... i>(std::index_sequence<i...>) {
    return std::vector<Lens>{std::variant_alternative_t<i, Lens>{}...};
  }
  (std::make_index_sequence<std::variant_size_v<Lens>>{});
}

LensInterop lens_interop(const Lens& lens) {
  return with_lens(lens, [](auto l) { return l.interop; });
}

bool is_perspective(const Lens& lens) {
  return with_lens(lens, [](auto l) { return std::is_base_of_v<Perspective, decltype(l)>; });
}

std::optional<Lens> find_lens(const std::string& name) {
  for (const Lens& lens : all_lenses())
    if (lens_name(lens) == name) return lens;
  return {};
}

}  // namespace touchtrace
