#include "pipeline/label/learn_box.h"

#include <ceres/ceres.h>

#include <array>

#include "pipeline/label/body_fit.h"
#include "pipeline/label/parallel.h"

namespace touchtrace::label {
namespace {

constexpr int rounds = 3, most_iterations = 25;
constexpr std::size_t view_points = 300;
constexpr double least_radius_m = 0.002, passing_radii = 2.0;
constexpr double compactness = 1.0;  // points' worth of each half extent: holds what nothing shows

template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

double value_of(double scalar) { return scalar; }
template <class Scalar, int count>
double value_of(const ceres::Jet<Scalar, count>& scalar) {
  return scalar.a;
}
template <class Scalar>
Eigen::Vector3d values_of(const Vector3<Scalar>& vector) {
  return {value_of(vector.x()), value_of(vector.y()), value_of(vector.z())};
}

/// Half extents and radius, as the solver has them.
using Shape = std::array<double, 4>;

RoundedBox box_of(const Shape& shape) { return {{shape[0], shape[1], shape[2]}, shape[3]}; }

template <class Scalar>
Scalar distance(const Scalar* shape, const Vector3<Scalar>& point) {
  return distance_from_box<Scalar>(point, Vector3<Scalar>(shape[0], shape[1], shape[2]), shape[3]);
}

/// A view's camera_from_body.
struct Pose {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d place_m;
};

template <class Scalar>
Vector3<Scalar> in_body(const Eigen::Vector3d& point, const Scalar* rotation, const Scalar* place) {
  const Eigen::Map<const Eigen::Quaternion<Scalar>> turn(rotation);
  const Eigen::Map<const Vector3<Scalar>> at(place);
  return turn.conjugate() * Vector3<Scalar>(point.cast<Scalar>() - at);
}

struct PointDistance {
  Eigen::Vector3d point_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* place,
                  Scalar* residual) const {
    residual[0] = distance(shape, in_body(point_m, rotation, place));
    return true;
  }
};

/// How deep a ray enters. Where it is deepest may stand still while that is differentiated.
struct RayDepth {
  Eigen::Vector3d eye_m, end_m;

  template <class Scalar>
  bool operator()(const Scalar* shape, const Scalar* rotation, const Scalar* place,
                  Scalar* residual) const {
    const Vector3<Scalar> from = in_body(eye_m, rotation, place),
                          to = in_body(end_m, rotation, place);
    const Eigen::Vector3d start = values_of<Scalar>(from), end = values_of<Scalar>(to);
    const auto deepest = deepest_point(
        box_of({value_of(shape[0]), value_of(shape[1]), value_of(shape[2]), value_of(shape[3])}),
        start, end);
    residual[0] = Scalar(0.0);
    if (!deepest) return true;
    const double part = (*deepest - start).norm() / (end - start).norm();
    const Scalar depth = distance<Scalar>(shape, from + Scalar(part) * (to - from));
    if (depth < Scalar(0.0)) residual[0] = depth;
    return true;
  }
};

struct Compactness {
  template <class Scalar>
  bool operator()(const Scalar* shape, Scalar* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = Scalar(compactness) * (shape[i] + shape[3]);
    return true;
  }
};

/// RobustLoss, of squares: as poses are fitted.
class SquaresLoss : public ceres::LossFunction {
 public:
  void Evaluate(double square, double out[3]) const override {
    const double inlying = width2_ / (width2_ + square);
    out[0] = inlying * square;
    out[1] = inlying * inlying;
    out[2] = -2.0 * inlying * inlying * inlying / width2_;
  }

 private:
  double width2_ = fine_width_m * fine_width_m;
};

template <class Residual>
void add(ceres::Problem& problem, Residual* residual, Shape& shape, Pose& pose) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 1, 4, 4, 3>(residual),
                           new SquaresLoss, shape.data(), pose.rotation.coeffs().data(),
                           pose.place_m.data());
}

void add_view(ceres::Problem& problem, const BodyView& view, Shape& shape, Pose& pose) {
  for (const auto& point : view.on_m)
    add(problem, new PointDistance{point.cast<double>()}, shape, pose);
  for (const auto& end : view.seen_past_m)
    add(problem, new RayDepth{view.eye_m, end.cast<double>()}, shape, pose);
  problem.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
}

/// Shape and poses together, from poses that are right but for the shape.
RoundedBox refine(const std::vector<BodyView>& views, const RoundedBox& start,
                  std::vector<Pose> poses) {
  Shape shape{start.inner_m.x(), start.inner_m.y(), start.inner_m.z(), start.radius_m};
  ceres::Problem problem;
  for (std::size_t i = 0; i < views.size(); ++i) add_view(problem, views[i], shape, poses[i]);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Compactness, 3, 4>(new Compactness),
                           nullptr, shape.data());
  for (int i = 0; i < 3; ++i) problem.SetParameterLowerBound(shape.data(), i, 0.0);
  problem.SetParameterLowerBound(shape.data(), 3, least_radius_m);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = most_iterations;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return box_of(shape);
}

std::vector<Pose> poses_of(const std::vector<BodyView>& views, const RoundedBox& box, int threads) {
  std::vector<Pose> poses(views.size());
  for_each_index(views.size(), threads, [&](std::size_t i) {
    const auto pose = fit_body_anyhow(views[i], box).camera_from_body;
    poses[i] = {Eigen::Quaterniond(pose.linear()), pose.translation()};
  });
  return poses;
}

}  // namespace

RoundedBox learn_box(const std::vector<BodyView>& views, double radius_m, int threads) {
  RoundedBox box{radius_m * Eigen::Vector3d(0.2, 0.4, 0.7), 0.5 * radius_m};
  std::vector<BodyView> thin;
  for (const auto& view : views)
    thin.push_back(thinned(view, likely_center(view, box), passing_radii * radius_m, view_points));
  for (int round = 0; round < rounds; ++round)
    box = refine(thin, box, poses_of(thin, box, threads));
  return box;
}

}  // namespace touchtrace::label
