#include "calib/camera/projection_jacobian.h"

#include <ceres/jet.h>

#include <limits>

namespace touchtrace {
namespace {

using Jet = ceres::Jet<double, 3>;

template <class L>
Eigen::Matrix<double, 2, 3> jacobian_of(const std::array<double, max_intrinsics>& intrinsics,
                                        const Eigen::Vector3d& point_m) {
  std::array<Jet, max_intrinsics> constants;
  for (std::size_t i = 0; i < intrinsics.size(); ++i) constants[i] = Jet(intrinsics[i]);
  const Vector3<Jet> point(Jet(point_m.x(), 0), Jet(point_m.y(), 1), Jet(point_m.z(), 2));
  const Vector2<Jet> pixel = project_point<L>(constants.data(), point);
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << pixel.x().v.transpose(), pixel.y().v.transpose();
  return jacobian;
}

}  // namespace

Eigen::Matrix<double, 2, 3> projection_jacobian(const Camera& camera,
                                                const Eigen::Vector3d& point_m) {
  return with_lens(camera.lens, [&](auto lens) -> Eigen::Matrix<double, 2, 3> {
    if (!lens.can_project(point_m))
      return Eigen::Matrix<double, 2, 3>::Constant(std::numeric_limits<double>::quiet_NaN());
    return jacobian_of<decltype(lens)>(camera.parameters(), point_m);
  });
}

}  // namespace touchtrace
