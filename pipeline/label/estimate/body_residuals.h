#pragma once

#include <ceres/ceres.h>

#include <algorithm>
#include <array>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/rounded_body.h"

/// Ceres residuals [m] and loss of ShapeProblem. Parameters: shape [4], rotation [4, quaternion
/// x y z w, camera from body], position [3].
namespace touchtrace::label::residuals {

template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

inline double value_of(double scalar) { return scalar; }
template <class Scalar, int count>
double value_of(const ceres::Jet<Scalar, count>& scalar) {
  return scalar.a;
}
template <class Scalar>
Eigen::Vector3d values_of(const Vector3<Scalar>& vector) {
  return {value_of(vector.x()), value_of(vector.y()), value_of(vector.z())};
}

template <std::size_t count, class Scalar>
std::array<double, count> values_of(const Scalar* scalars) {
  std::array<double, count> result;
  std::transform(scalars, scalars + count, result.begin(),
                 [](const Scalar& scalar) { return value_of(scalar); });
  return result;
}

/// Half extents of the core and radius of the edges [m].
using Shape = std::array<double, 4>;

/// Index of the core's y extent: a cylinder uses its x extent for both.
inline std::size_t second_width(Core core) { return core == Core::cylinder ? 0 : 1; }

template <class Scalar>
Vector3<Scalar> inner(Core core, const Scalar* shape) {
  return {shape[0], shape[second_width(core)], shape[2]};
}

inline RoundedBody body_of(Core core, const Shape& shape) {
  return {inner(core, shape.data()), shape[3], core};
}

template <class Scalar>
RoundedBody body_at(Core core, const Scalar* shape) {
  return body_of(core, values_of<4>(shape));
}

template <class Scalar>
Scalar distance(Core core, const Scalar* shape, const Vector3<Scalar>& point) {
  return distance_from_body<Scalar>(core, point, inner(core, shape), shape[3]);
}

template <class Scalar>
Vector3<Scalar> in_body(const Eigen::Vector3d& point, const Scalar* rotation,
                        const Scalar* position) {
  const Eigen::Map<const Eigen::Quaternion<Scalar>> camera_from_body(rotation);
  const Eigen::Map<const Vector3<Scalar>> translation(position);
  return camera_from_body.conjugate() * Vector3<Scalar>(point.cast<Scalar>() - translation);
}

/// Weighted distance of a point to the surface. The weight is not differentiated.
struct PointDistance {
  const BodyView& view;
  Core core;
  Eigen::Vector3d point_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* position,
                  Scalar* residual) const {
    const Vector3<Scalar> point = in_body(point_m, rotation, position);
    const Eigen::Vector3d value = values_of<Scalar>(point),
                          origin = in_body(view.origin_m, values_of<4>(rotation).data(),
                                           values_of<3>(position).data());
    const auto surface = surface_distance(body_at(core, shape), value);
    residual[0] = Scalar(view.residual_weight(surface.outward, value - origin)) *
                  distance(core, shape, point);
    return true;
  }
};

/// Depth by which a ray enters the body (negative); 0 if it misses it. The position of the deepest
/// point along the ray is not differentiated: at the deepest point that derivative is 0.
struct RayDepth {
  Core core;
  Eigen::Vector3d origin_m, end_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* position,
                  Scalar* residual) const {
    const auto rotation_values = values_of<4>(rotation);
    const auto position_values = values_of<3>(position);
    const Eigen::Vector3d start = in_body(origin_m, rotation_values.data(), position_values.data()),
                          end = in_body(end_m, rotation_values.data(), position_values.data());
    const auto deepest = deepest_point(body_at(core, shape), start, end);
    residual[0] = Scalar(0.0);
    if (!deepest) return true;  // most rays miss
    const Vector3<Scalar> from = in_body(origin_m, rotation, position),
                          to = in_body(end_m, rotation, position);
    const double part = (*deepest - start).norm() / (end - start).norm();
    const Scalar depth = distance<Scalar>(core, shape, from + Scalar(part) * (to - from));
    if (depth < Scalar(0.0)) residual[0] = depth;
    return true;
  }
};

/// Signed distance by which the body extends beyond a box plane, over the plane's sigma_ratio.
struct PlaneDistance {
  const BoxPlanes& planes;
  Core core;
  Eigen::Vector3d outward;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* position,
                  Scalar* residual) const {
    const Eigen::Map<const Eigen::Quaternion<Scalar>> camera_from_body(rotation);
    const Vector3<Scalar> direction = camera_from_body.conjugate() * outward.cast<Scalar>(),
                          support = core_support_point<Scalar>(core, direction, inner(core, shape));
    const Scalar centre = outward.cast<Scalar>().dot(Eigen::Map<const Vector3<Scalar>>(position));
    residual[0] = (centre + support.dot(direction) + shape[3]) / planes.sigma_ratio;
    return true;
  }
};

/// Half extents times `weight`: a prior for small bodies.
struct Compactness {
  Core core;
  double weight;

  template <class Scalar>
  bool operator()(const Scalar* shape, Scalar* residual) const {
    Eigen::Map<Vector3<Scalar>>(residual, 3) =
        Scalar(weight) * (inner(core, shape).array() + shape[3]);
    return true;
  }
};

/// GemanMcClureLoss as Ceres wants it: twice the cost, as a function of the squared residual.
class SquaredGemanMcClureLoss : public ceres::LossFunction {
 public:
  explicit SquaredGemanMcClureLoss(double width_m) : loss_{width_m} {}

  void Evaluate(double square_m2, double rho[3]) const override {
    const double inlier = loss_.inlier_factor(square_m2);
    rho[0] = inlier * square_m2;
    rho[1] = inlier * inlier;
    rho[2] = -2.0 * inlier * inlier * inlier / (loss_.width_m * loss_.width_m);
  }

 private:
  GemanMcClureLoss loss_;
};

}  // namespace touchtrace::label::residuals
