#include "pipeline/label/estimate/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace touchtrace::label {
namespace {

using Matrix6 = BodyFit::Matrix6;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Smaller steps end the iteration.
constexpr double min_translation_m = 5e-5, min_rotation_rad = 1e-3;
constexpr double prior_sigma_m = 0.003;  // of a point; scales the rotation's prior to metres
constexpr double initial_damping = 1e-3, min_damping = 1e-6, damping_factor = 10.0;

/// Gauss-Newton normal equations at one pose, for a step (translation, rotation) in the body frame.
struct NormalEquations {
  Matrix6 normal = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double cost = 0.0;

  void add(const SurfaceDistance& surface, const Eigen::Vector3d& point, double residual_weight,
           const GemanMcClureLoss& loss) {
    Vector6 jacobian;
    jacobian << -residual_weight * surface.outward, residual_weight * surface.outward.cross(point);
    add(jacobian, residual_weight * surface.distance_m, loss);
  }

  /// Adds a box plane with normal `outward`, `distance_m` from the body's centre; body frame.
  void add_plane(const RoundedBody& body, const Eigen::Vector3d& outward, double distance_m,
                 double residual_weight) {
    const Eigen::Vector3d support = core_support_point(body.core, outward, body.inner_m);
    Vector6 jacobian;
    jacobian << residual_weight * outward, residual_weight * support.cross(outward);
    add(jacobian, residual_weight * (support.dot(outward) + body.radius_m - distance_m),
        plane_loss);
  }

 private:
  template <class Loss>
  void add(const Vector6& jacobian, double residual, const Loss& loss) {
    const double weight = loss.weight(residual);
    normal.noalias() += jacobian * (weight * jacobian).transpose();
    gradient += weight * residual * jacobian;
    cost += loss.cost(residual);
  }
};

NormalEquations equations_at(const BodyView& view, const RoundedBody& body,
                             const Eigen::Isometry3d& camera_from_body,
                             const GemanMcClureLoss& loss) {
  NormalEquations equations;
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  const Eigen::Vector3d origin = body_from_camera * view.origin_m;
  for (const auto& measured : view.surface_points) {
    const Eigen::Vector3d point = body_from_camera * measured.cast<double>();
    const auto surface = surface_distance(body, point);
    equations.add(surface, point, view.residual_weight(surface.outward, point - origin), loss);
  }
  for (const auto& end : view.free_space_endpoints) {
    const auto deepest = deepest_point(body, origin, body_from_camera * end.cast<double>());
    if (!deepest) continue;
    const auto surface = surface_distance(body, *deepest);
    if (surface.distance_m < 0.0) equations.add(surface, *deepest, 1.0, loss);
  }
  for (const auto& outward : view.box.outward)
    equations.add_plane(body, camera_from_body.linear().transpose() * outward,
                        -outward.dot(camera_from_body.translation()), 1.0 / view.box.sigma_ratio);
  return equations;
}

/// Adds a pose's prior to normal equations.
class PriorTerms {
 public:
  explicit PriorTerms(const PosePrior& prior)
      : start_(prior.start),
        position_weight_(prior.position_weight),
        rotation_weight_(std::pow(prior_sigma_m / prior.rotation_sigma_rad, 2)) {}

  void add_to(NormalEquations& equations, const Eigen::Isometry3d& pose) const {
    const Eigen::AngleAxisd rotation(start_.linear().transpose() * pose.linear());
    Vector6 offset, weights;
    offset << pose.linear().transpose() * (pose.translation() - start_.translation()),
        rotation.angle() * rotation.axis();
    weights << position_weight_, position_weight_, position_weight_, rotation_weight_,
        rotation_weight_, rotation_weight_;
    equations.normal.diagonal() += weights;
    equations.gradient += weights.cwiseProduct(offset);
    equations.cost += 0.5 * weights.dot(offset.cwiseAbs2());
  }

 private:
  const Eigen::Isometry3d& start_;
  double position_weight_, rotation_weight_;
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
  Matrix6 rotation = Matrix6::Zero();
  rotation.topLeftCorner<3, 3>() = rotation.bottomRightCorner<3, 3>() = pose.linear();
  const Matrix6 normal = equations.normal.selfadjointView<Eigen::Lower>();
  return {pose, rotation * normal * rotation.transpose(), equations.cost};
}

}  // namespace

BodyFit optimize_pose(const BodyView& view, const RoundedBody& body, const PosePrior& prior,
                      double loss_width_m, int max_steps) {
  const PriorTerms prior_terms(prior);
  const auto equations = [&](const Eigen::Isometry3d& pose) {
    auto result = equations_at(view, body, pose, {loss_width_m});
    prior_terms.add_to(result, pose);
    return result;
  };
  Eigen::Isometry3d pose = prior.start;
  auto current = equations(pose);
  double damping = initial_damping;
  for (int i = 0; i < max_steps; ++i) {
    const Vector6 step = damped_step(current, damping);
    const auto next = moved(pose, step);
    const auto candidate = equations(next);
    if (candidate.cost < current.cost) {
      pose = next, current = candidate;
      damping = std::max(min_damping, damping / damping_factor);
    } else {
      damping *= damping_factor;
    }
    if (step.head<3>().norm() < min_translation_m && step.tail<3>().norm() < min_rotation_rad)
      break;
  }
  return fit_of(pose, current);
}

}  // namespace touchtrace::label
