#include "pipeline/label/estimate/body_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/statistics.h"
#include "pipeline/label/estimate/pose_optimizer.h"

namespace touchtrace::label {
namespace {

constexpr int max_fine_steps = 20, max_coarse_steps = 10;
constexpr std::size_t coarse_points = 150, refined_starts = 5;
constexpr int num_rotations = 32;  // for a box 128: half turns about its axes are symmetries
constexpr double negligible_position_weight = 0.01;  // keeps the equations regular
constexpr double centroid_depth = 0.67;              // centroid to centre, in mean half extents

/// Whether a ray passes within `reach_m` of the coordinate origin.
bool passes_near_zero(const Eigen::Vector3d& from, const Eigen::Vector3d& end, double reach_m) {
  const Eigen::Vector3d along = end - from;
  const double part = std::clamp(-from.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (from + part * along).squaredNorm() < reach_m * reach_m;
}

/// Uniform sample of SO(3): super-Fibonacci spirals (Alexa, CVPR 2022).
Eigen::Quaterniond fibonacci_rotation(int index) {
  constexpr double phi = 1.4142135623730951, psi = 1.5337511687552043;
  const double s = index + 0.5, t = s / num_rotations;
  const double r = std::sqrt(t), other = std::sqrt(1.0 - t);
  const double alpha = 2.0 * M_PI * s / phi, beta = 2.0 * M_PI * s / psi;
  return {other * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), other * std::sin(beta)};
}

/// Rotations that permute a box's axes. A visible face may be any of its faces.
const std::array<Eigen::Quaterniond, 5>& axis_permutations() {
  const double h = std::sqrt(0.5);
  static const std::array<Eigen::Quaterniond, 5> all{
      Eigen::Quaterniond(h, h, 0.0, 0.0), Eigen::Quaterniond(h, 0.0, h, 0.0),
      Eigen::Quaterniond(h, 0.0, 0.0, h), Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5),
      Eigen::Quaterniond(0.5, -0.5, -0.5, -0.5)};
  return all;
}

/// Fits from all rotations with the coarse loss and few points, by increasing cost.
std::vector<BodyFit> coarse_fits(const BodyView& view, const RoundedBody& body,
                                 double position_weight) {
  const Eigen::Vector3d centre = initial_centre(view, body);
  const auto sample = subsample(view, centre, body.circumradius_m(), coarse_points);
  std::vector<BodyFit> fits;
  for (int i = 0; i < num_rotations; ++i) {
    Eigen::Isometry3d start(fibonacci_rotation(i));
    start.pretranslate(centre);
    fits.push_back(optimize_pose(sample, body, {start, unknown_rotation_sigma_rad, position_weight},
                                 coarse_loss_width_m, max_coarse_steps));
  }
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  return fits;
}

/// Pose with the given rotation whose surface passes through the centroid of the surface points.
Eigen::Isometry3d pose_behind_centroid(const BodyView& view, const RoundedBody& body,
                                       const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d centroid = view.centroid_m(), ray = (centroid - view.origin_m).normalized();
  const Eigen::Array3d along_axes = (rotation.transpose() * ray).array().abs();
  const double behind_m = (body.half_extents_m().array() / along_axes).minCoeff();
  Eigen::Isometry3d pose(rotation);
  pose.pretranslate(centroid + behind_m * ray);
  return pose;
}

}  // namespace

Eigen::Matrix3d BodyFit::centre_information() const {
  const Eigen::Matrix3d across = information.topRightCorner<3, 3>();
  return information.topLeftCorner<3, 3>() -
         across * information.bottomRightCorner<3, 3>().inverse() * across.transpose();
}

Eigen::Vector3d initial_centre(const BodyView& view, const RoundedBody& body) {
  const Eigen::Vector3d centroid = view.centroid_m();
  const double behind_m = centroid_depth * (body.radius_m + body.inner_m.mean());
  return centroid + behind_m * (centroid - view.origin_m).normalized();
}

BodyView subsample(const BodyView& view, const Eigen::Vector3d& centre_m, double reach_m,
                   std::size_t max_points) {
  const Eigen::Vector3d origin = view.origin_m - centre_m;
  std::vector<Eigen::Vector3f> passing;
  for (const auto& end : view.free_space_endpoints)
    if (passes_near_zero(origin, end.cast<double>() - centre_m, reach_m)) passing.push_back(end);
  return {view.origin_m,
          every_nth(view.surface_points, max_points),
          every_nth(passing, max_points),
          view.noise_ratio,
          view.pixel_angular_size,
          view.box};
}

std::vector<Eigen::Vector3f> every_nth(const std::vector<Eigen::Vector3f>& points,
                                       std::size_t max_points) {
  const std::size_t stride = 1 + points.size() / max_points;
  std::vector<Eigen::Vector3f> some;
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  return some;
}

double median_distance_m(const std::vector<Eigen::Vector3f>& points, const RoundedBody& body,
                         const Eigen::Isometry3d& camera_from_body) {
  const Eigen::Isometry3d body_from_camera = camera_from_body.inverse();
  std::vector<double> distances_m;
  for (const auto& point : points)
    distances_m.push_back(
        std::abs(surface_distance(body, body_from_camera * point.cast<double>()).distance_m));
  return median(std::move(distances_m));
}

BodyFit fit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                 double rotation_sigma_rad) {
  const auto coarse =
      optimize_pose(view, body, {start, rotation_sigma_rad}, coarse_loss_width_m, max_fine_steps);
  return optimize_pose(view, body, {coarse.camera_from_body, rotation_sigma_rad}, fine_loss_width_m,
                       max_fine_steps);
}

BodyFit refit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                   double rotation_sigma_rad) {
  return optimize_pose(view, body, {start, rotation_sigma_rad}, fine_loss_width_m, max_fine_steps);
}

std::vector<BodyFit> global_pose_candidates(const BodyView& view, const RoundedBody& body,
                                            double position_weight) {
  const auto refit = [&](const Eigen::Isometry3d& start) {
    return optimize_pose(view, body, {start, unknown_rotation_sigma_rad, position_weight},
                         fine_loss_width_m, max_fine_steps);
  };
  auto fits = coarse_fits(view, body, position_weight);
  fits.resize(refined_starts);
  for (auto& fit : fits) fit = refit(fit.camera_from_body);
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  const Eigen::Matrix3d best = fits.front().camera_from_body.linear();
  for (const Eigen::Quaterniond& permutation : axis_permutations())
    fits.push_back(refit(pose_behind_centroid(view, body, best * permutation)));
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  return fits;
}

BodyFit fit_body_near(const BodyView& view, const RoundedBody& body,
                      const Eigen::Isometry3d& start) {
  const auto refit = [&](const Eigen::Isometry3d& pose) {
    return optimize_pose(view, body, {pose, unknown_rotation_sigma_rad, negligible_position_weight},
                         fine_loss_width_m, max_fine_steps);
  };
  auto best = refit(start);
  const Eigen::Matrix3d rotation = best.camera_from_body.linear();
  for (const Eigen::Quaterniond& permutation : axis_permutations()) {
    const auto fit = refit(pose_behind_centroid(view, body, rotation * permutation));
    if (fit.cost_m2 < best.cost_m2) best = fit;
  }
  return best;
}

BodyFit fit_body_globally(const BodyView& view, const RoundedBody& body) {
  return global_pose_candidates(view, body, negligible_position_weight).front();
}

}  // namespace touchtrace::label
