#pragma once

#include <ceres/ceres.h>

#include <algorithm>
#include <array>

#include "pipeline/label/body_view.h"
#include "pipeline/label/rounded_body.h"

/// What Ceres needs to learn a body: residuals [m] of a shape and of a view's pose, and their loss.
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
std::array<double, count> numbers(const Scalar* scalars) {
  std::array<double, count> result;
  std::transform(scalars, scalars + count, result.begin(),
                 [](const Scalar& scalar) { return value_of(scalar); });
  return result;
}

/// Half extents and radius, as the solver has them.
using Shape = std::array<double, 4>;

/// Both widths of a cylinder's core are the first number.
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
  return body_of(core, numbers<4>(shape));
}

template <class Scalar>
Scalar distance(Core core, const Scalar* shape, const Vector3<Scalar>& point) {
  return distance_from_body<Scalar>(core, point, inner(core, shape), shape[3]);
}

template <class Scalar>
Vector3<Scalar> in_body(const Eigen::Vector3d& point, const Scalar* rotation, const Scalar* place) {
  const Eigen::Map<const Eigen::Quaternion<Scalar>> turn(rotation);
  const Eigen::Map<const Vector3<Scalar>> at(place);
  return turn.conjugate() * Vector3<Scalar>(point.cast<Scalar>() - at);
}

/// As much of it as counts, which may stand still while that is differentiated.
struct PointDistance {
  const BodyView& view;
  Core core;
  Eigen::Vector3d point_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* place,
                  Scalar* residual) const {
    const Vector3<Scalar> point = in_body(point_m, rotation, place);
    const Eigen::Vector3d now = values_of<Scalar>(point),
                          eye = in_body(view.eye_m, numbers<4>(rotation).data(),
                                        numbers<3>(place).data());
    const auto surface = surface_distance(body_at(core, shape), now);
    residual[0] =
        Scalar(view.counted_part(surface.outward, now - eye)) * distance(core, shape, point);
    return true;
  }
};

/// How deep a ray enters. Where it is deepest may stand still while that is differentiated.
struct RayDepth {
  Core core;
  Eigen::Vector3d eye_m, end_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* place,
                  Scalar* residual) const {
    const Vector3<Scalar> from = in_body(eye_m, rotation, place),
                          to = in_body(end_m, rotation, place);
    const Eigen::Vector3d start = values_of<Scalar>(from), end = values_of<Scalar>(to);
    const auto deepest = deepest_point(body_at(core, shape), start, end);
    residual[0] = Scalar(0.0);
    if (!deepest) return true;
    const double part = (*deepest - start).norm() / (end - start).norm();
    const Scalar depth = distance<Scalar>(core, shape, from + Scalar(part) * (to - from));
    if (depth < Scalar(0.0)) residual[0] = depth;
    return true;
  }
};

/// How far it reaches past a marked side, less than 0 where it falls short of it; in terms of
/// points.
struct SideDistance {
  const MarkedSides& marked;
  Core core;
  Eigen::Vector3d outward;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* place,
                  Scalar* residual) const {
    const Eigen::Map<const Eigen::Quaternion<Scalar>> turn(rotation);
    const Vector3<Scalar> toward = turn.conjugate() * outward.cast<Scalar>(),
                          farthest = farthest_of_core<Scalar>(core, toward, inner(core, shape));
    const Scalar middle = outward.cast<Scalar>().dot(Eigen::Map<const Vector3<Scalar>>(place));
    residual[0] = (middle + farthest.dot(toward) + shape[3]) / marked.sigma_in_points;
    return true;
  }
};

/// Half extents, as much of them as counts.
struct Compactness {
  Core core;
  double part;

  template <class Scalar>
  bool operator()(const Scalar* shape, Scalar* residual) const {
    Eigen::Map<Vector3<Scalar>>(residual, 3) =
        Scalar(part) * (inner(core, shape).array() + shape[3]);
    return true;
  }
};

/// RobustLoss, of squares: as poses are fitted.
class SquaresLoss : public ceres::LossFunction {
 public:
  explicit SquaresLoss(double width_m) : width2_(width_m * width_m) {}

  void Evaluate(double square, double out[3]) const override {
    const double inlying = width2_ / (width2_ + square);
    out[0] = inlying * square;
    out[1] = inlying * inlying;
    out[2] = -2.0 * inlying * inlying * inlying / width2_;
  }

 private:
  double width2_;
};

}  // namespace touchtrace::label::residuals
