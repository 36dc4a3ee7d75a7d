#include "pipeline/label/pose_descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace touchtrace::label {
namespace {

using Matrix6 = BodyFit::Matrix6;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double still_place_m = 5e-5, still_turn_rad = 1e-3;
constexpr double prior_point_m = 0.003;  // deviation of the point that a prior is worth
constexpr double first_damping = 1e-3, least_damping = 1e-6, damping_factor = 10.0;

/// The normal equations at one pose; place and rotation along the body's axes.
struct NormalEquations {
  Matrix6 normal = Matrix6::Zero();  ///< lower half
  Vector6 gradient = Vector6::Zero();
  double cost = 0.0;

  /// `part` of a distance counts.
  void add(const SurfaceDistance& surface, const Eigen::Vector3d& point, double part,
           const RobustLoss& loss) {
    Vector6 jacobian;
    jacobian << -part * surface.outward, part * surface.outward.cross(point);
    add(jacobian, part * surface.distance_m, loss);
  }

  /// A plane at `past_m` beyond the body's middle should touch it; as much of that counts.
  void add_side(const RoundedBody& body, const Eigen::Vector3d& outward, double past_m,
                double part) {
    const Eigen::Vector3d farthest = farthest_of_core(body.core, outward, body.inner_m);
    Vector6 jacobian;
    jacobian << part * outward, part * farthest.cross(outward);
    add(jacobian, part * (farthest.dot(outward) + body.radius_m - past_m), side_loss);
  }

 private:
  template <class Loss>
  void add(const Vector6& jacobian, double residual, const Loss& loss) {
    const double weight = loss.weight(residual);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
    gradient += weight * residual * jacobian;
    cost += loss.cost(residual);
  }
};

NormalEquations equations_at(const BodyView& view, const RoundedBody& body,
                             const Eigen::Isometry3d& camera_from_body, const RobustLoss& loss) {
  NormalEquations equations;
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  const Eigen::Vector3d eye = body_from_camera * view.eye_m;
  for (const auto& seen : view.on_m) {
    const Eigen::Vector3d point = body_from_camera * seen.cast<double>();
    const auto surface = surface_distance(body, point);
    equations.add(surface, point, view.counted_part(surface.outward, point - eye), loss);
  }
  for (const auto& end : view.seen_past_m) {
    const auto deepest = deepest_point(body, eye, body_from_camera * end.cast<double>());
    if (!deepest) continue;
    const auto surface = surface_distance(body, *deepest);
    if (surface.distance_m < 0.0) equations.add(surface, *deepest, 1.0, loss);
  }
  for (const auto& outward : view.marked.outward)
    equations.add_side(body, camera_from_body.linear().transpose() * outward,
                       -outward.dot(camera_from_body.translation()),
                       1.0 / view.marked.sigma_in_points);
  return equations;
}

/// The prior as two more squares: of its place and its rotation.
class PriorSquares {
 public:
  explicit PriorSquares(const PosePrior& prior)
      : start_(prior.start),
        place_(prior.place_points),
        turn_(std::pow(prior_point_m / prior.rotation_sigma_rad, 2)) {}

  void add_to(NormalEquations& equations, const Eigen::Isometry3d& pose) const {
    const Eigen::AngleAxisd turned(start_.linear().transpose() * pose.linear());
    Vector6 offset, weights;
    offset << pose.linear().transpose() * (pose.translation() - start_.translation()),
        turned.angle() * turned.axis();
    weights << place_, place_, place_, turn_, turn_, turn_;
    equations.normal.diagonal() += weights;
    equations.gradient += weights.cwiseProduct(offset);
    equations.cost += 0.5 * weights.dot(offset.cwiseAbs2());
  }

 private:
  const Eigen::Isometry3d& start_;
  double place_, turn_;
};

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Vector6& step) {
  Eigen::Isometry3d result = pose;
  result.translate(Eigen::Vector3d(step.head<3>()));
  if (const double angle = step.tail<3>().norm(); angle > 0.0)
    result.rotate(Eigen::AngleAxisd(angle, step.tail<3>() / angle));
  return result;
}

Vector6 damped_step(const NormalEquations& equations, double damping) {
  Matrix6 damped = equations.normal;
  damped.diagonal() *= 1.0 + damping;
  return -damped.selfadjointView<Eigen::Lower>().ldlt().solve(equations.gradient);
}

BodyFit fit_of(const Eigen::Isometry3d& pose, const NormalEquations& equations) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.linear();
  const Matrix6 normal = equations.normal.selfadjointView<Eigen::Lower>();
  return {pose, turn * normal * turn.transpose(), equations.cost};
}

}  // namespace

BodyFit descend(const BodyView& view, const RoundedBody& body, const PosePrior& prior,
                double loss_width_m, int most_steps) {
  const PriorSquares squares(prior);
  const auto equations = [&](const Eigen::Isometry3d& pose) {
    auto result = equations_at(view, body, pose, {loss_width_m});
    squares.add_to(result, pose);
    return result;
  };
  Eigen::Isometry3d pose = prior.start;
  auto here = equations(pose);
  double damping = first_damping;
  for (int i = 0; i < most_steps; ++i) {
    const Vector6 step = damped_step(here, damping);
    const auto next = moved(pose, step);
    const auto there = equations(next);
    if (there.cost < here.cost) {
      pose = next, here = there;
      damping = std::max(least_damping, damping / damping_factor);
    } else {
      damping *= damping_factor;
    }
    if (step.head<3>().norm() < still_place_m && step.tail<3>().norm() < still_turn_rad) break;
  }
  return fit_of(pose, here);
}

}  // namespace touchtrace::label
