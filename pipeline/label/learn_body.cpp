#include "pipeline/label/learn_body.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "pipeline/label/body_fit.h"

namespace touchtrace::label {
namespace {

constexpr int rounds = 3, more_rounds = 6, most_iterations = 25;
constexpr double helped = 0.995;  // part of the cost that a round which helped leaves
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
std::size_t second_width(Core core) { return core == Core::cylinder ? 0 : 1; }

template <class Scalar>
Vector3<Scalar> inner(Core core, const Scalar* shape) {
  return {shape[0], shape[second_width(core)], shape[2]};
}

RoundedBody body_of(Core core, const Shape& shape) {
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

struct Compactness {
  Core core;

  template <class Scalar>
  bool operator()(const Scalar* shape, Scalar* residual) const {
    Eigen::Map<Vector3<Scalar>>(residual, 3) =
        Scalar(compactness) * (inner(core, shape).array() + shape[3]);
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

template <class Residual>
void add(ceres::Problem& problem, Residual* residual, double width_m, Shape& shape, Pose& pose) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 1, 4, 4, 3>(residual),
                           new SquaresLoss(width_m), shape.data(), pose.rotation.coeffs().data(),
                           pose.place_m.data());
}

void add_view(ceres::Problem& problem, const BodyView& view, Core core, double width_m,
              Shape& shape, Pose& pose) {
  for (const auto& point : view.on_m)
    add(problem, new PointDistance{view, core, point.cast<double>()}, width_m, shape, pose);
  for (const auto& end : view.seen_past_m)
    add(problem, new RayDepth{core, view.eye_m, end.cast<double>()}, width_m, shape, pose);
  problem.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
}

/// A shape and how all views fit it; its compactness is part of the cost.
struct Learnt {
  RoundedBody body;
  std::vector<BodyFit> fits;
  double cost_m2 = 0.0;
};

Learnt fitted(const std::vector<BodyView>& views, const RoundedBody& body, int threads) {
  Learnt learnt{body, std::vector<BodyFit>(views.size())};
  for_each_index(views.size(), threads,
                 [&](std::size_t i) { learnt.fits[i] = fit_body_anyhow(views[i], body); });
  learnt.cost_m2 = 0.5 * (compactness * body.half_extents_m()).squaredNorm();
  for (const auto& fit : learnt.fits) learnt.cost_m2 += fit.cost_m2;
  return learnt;
}

std::vector<Pose> poses_of(const std::vector<BodyFit>& fits) {
  std::vector<Pose> poses;
  for (const auto& [pose, information, cost] : fits)
    poses.push_back({Eigen::Quaterniond(pose.linear()), pose.translation()});
  return poses;
}

/// Shape and poses together, from poses that are right but for the shape.
RoundedBody refine(const std::vector<BodyView>& views, const Learnt& start, double width_m) {
  Shape shape{start.body.inner_m.x(), start.body.inner_m.y(), start.body.inner_m.z(),
              start.body.radius_m};
  auto poses = poses_of(start.fits);
  ceres::Problem problem;
  for (std::size_t i = 0; i < views.size(); ++i)
    add_view(problem, views[i], start.body.core, width_m, shape, poses[i]);
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Compactness, 3, 4>(new Compactness{start.body.core}), nullptr,
      shape.data());
  for (int i = 0; i < 3; ++i) problem.SetParameterLowerBound(shape.data(), i, 0.0);
  problem.SetParameterLowerBound(shape.data(), 3, least_radius_m);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = most_iterations;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return body_of(start.body.core, shape);
}

/// Where a search for a shape begins: half extents and radius in radii of the sphere, and the width
/// of the first round's loss. A narrow one does not see what is far from where it begins, a wide
/// one grows to strays: which was right only the end tells.
struct Start {
  Core core;
  std::array<double, 3> inner;
  double edge, width_m;
};
constexpr std::array<Start, 4> starts{{{Core::box, {0.2, 0.4, 0.7}, 0.5, fine_width_m},
                                       {Core::box, {0.3, 0.3, 0.3}, 0.5, fine_width_m},
                                       {Core::box, {0.1, 0.8, 1.1}, 0.3, rough_width_m},
                                       {Core::cylinder, {0.4, 0.4, 0.8}, 0.3, fine_width_m}}};

Learnt learn_from(const Start& start, const std::vector<BodyView>& views, double radius_m,
                  int threads, Progress& progress) {
  const RoundedBody first{radius_m * Eigen::Vector3d(start.inner.data()), radius_m * start.edge,
                          start.core};
  auto at = fitted(views, first, threads);
  double width_m = start.width_m;
  for (int round = 0; round < rounds; ++round, width_m = std::max(fine_width_m, 0.5 * width_m)) {
    at = fitted(views, refine(views, at, width_m), threads);
    progress.advance();
  }
  return at;
}

/// More rounds, as long as they help.
RoundedBody settled(const std::vector<BodyView>& views, Learnt at, int threads,
                    Progress& progress) {
  for (int round = 0; round < more_rounds; ++round) {
    auto next = fitted(views, refine(views, at, fine_width_m), threads);
    progress.advance();
    if (!(next.cost_m2 < helped * at.cost_m2)) break;
    at = std::move(next);
  }
  return at.body;
}

}  // namespace

RoundedBody learn_body(const std::vector<BodyView>& views, double radius_m, int threads) {
  std::vector<BodyView> thin;
  for (const auto& view : views)
    thin.push_back(thinned(view, likely_center(view, {Eigen::Vector3d::Zero(), radius_m}),
                           passing_radii * radius_m, view_points));
  Progress progress("learning the object's shape", rounds * starts.size() + more_rounds);
  std::array<Learnt, starts.size()> learnt;
  // each on all threads: those of starts that are done help with the last
  for_each_index(starts.size(), threads, [&](std::size_t i) {
    learnt[i] = learn_from(starts[i], thin, radius_m, threads, progress);
  });
  return settled(thin, *std::ranges::min_element(learnt, {}, &Learnt::cost_m2), threads, progress);
}

}  // namespace touchtrace::label
