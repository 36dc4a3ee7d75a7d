#include "calib/camera/projection_jacobian.h"

#include <ceres/jet.h>

#include <limits>

namespace touchtrace {
namespace {

template <class L>
ProjectionJacobian differentiate(const double* intrinsics, const Eigen::Vector3d& p) {
  constexpr int num_coefficients = static_cast<int>(L::coefficients.size());
  using Jet = ceres::Jet<double, 3 + num_coefficients>;
  std::array<Jet, num_coefficients> k;
  for (int i = 0; i < num_coefficients; ++i) k[std::size_t(i)] = Jet(intrinsics[4 + i], 3 + i);
  const Vector2<Jet> distorted =
      L::distort(k.data(), L::normalize(Vector3<Jet>(Jet(p.x(), 0), Jet(p.y(), 1), Jet(p.z(), 2))));
  ProjectionJacobian result;
  result.by_intrinsics.setZero();
  for (int axis = 0; axis < 2; ++axis) {
    const double focal_px = intrinsics[axis];
    const auto& [value, derivatives] = distorted[axis];
    result.pixel[axis] = focal_px * value + intrinsics[2 + axis];
    result.by_point.row(axis) = focal_px * derivatives.template head<3>().transpose();
    auto by_intrinsics = result.by_intrinsics.row(axis);
    by_intrinsics[axis] = value, by_intrinsics[2 + axis] = 1.0;
    by_intrinsics.template segment<num_coefficients>(4) =
        focal_px * derivatives.template tail<num_coefficients>().transpose();
  }
  return result;
}

ProjectionJacobian not_a_projection() {
  ProjectionJacobian result;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  result.pixel.setConstant(nan), result.by_point.setConstant(nan);
  result.by_intrinsics.setConstant(nan);
  return result;
}

}  // namespace

ProjectionJacobian projection_jacobian(const Lens& lens, const double* intrinsics,
                                       const Eigen::Vector3d& point_m) {
  return with_lens(lens, [&](auto l) {
    return l.can_project(point_m) ? differentiate<decltype(l)>(intrinsics, point_m)
                                  : not_a_projection();
  });
}

ProjectionJacobian projection_jacobian(const Camera& camera, const Eigen::Vector3d& point_m) {
  return projection_jacobian(camera.lens, camera.parameters().data(), point_m);
}

}  // namespace touchtrace
