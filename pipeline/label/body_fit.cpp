#include "pipeline/label/body_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/label/pose_descent.h"

namespace touchtrace::label {
namespace {

constexpr int most_steps = 20, rough_steps = 10;
constexpr std::size_t rough_points = 150, kept_starts = 5;
constexpr int rotations = 32;  // of a box each is four: half turns about its axes look the same
/// Just as much as keeps equations regular.
constexpr double unknown_place_points = 0.01;
constexpr double seen_depth = 0.67;  // of a body's extent, from what is seen of it to its middle

/// Of what is seen.
Eigen::Vector3d middle_of(const BodyView& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& point : view.on_m) sum += point.cast<double>();
  return sum / static_cast<double>(view.on_m.size());
}

/// Whether a ray comes so near to the origin.
bool passes(const Eigen::Vector3d& eye, const Eigen::Vector3d& end, double reach_m) {
  const Eigen::Vector3d along = end - eye;
  const double part = std::clamp(-eye.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (eye + part * along).squaredNorm() < reach_m * reach_m;
}

std::vector<Eigen::Vector3f> some_of(const std::vector<Eigen::Vector3f>& points, std::size_t most) {
  const std::size_t stride = 1 + points.size() / most;
  std::vector<Eigen::Vector3f> some;
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  return some;
}

/// Evenly spread over all rotations (super-Fibonacci spirals; Alexa, CVPR 2022).
Eigen::Quaterniond spread_rotation(int index) {
  constexpr double phi = 1.4142135623730951, psi = 1.5337511687552043;
  const double s = index + 0.5, t = s / rotations;
  const double r = std::sqrt(t), other = std::sqrt(1.0 - t);
  const double alpha = 2.0 * M_PI * s / phi, beta = 2.0 * M_PI * s / psi;
  return {other * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), other * std::sin(beta)};
}

/// The rotations that give a box's axes each other's places: what shows of a box with one face is
/// often as well another face of it.
const std::array<Eigen::Quaterniond, 5>& exchanges() {
  const double h = std::sqrt(0.5);
  static const std::array<Eigen::Quaterniond, 5> all{
      Eigen::Quaterniond(h, h, 0.0, 0.0), Eigen::Quaterniond(h, 0.0, h, 0.0),
      Eigen::Quaterniond(h, 0.0, 0.0, h), Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5),
      Eigen::Quaterniond(0.5, -0.5, -0.5, -0.5)};
  return all;
}

/// From all rotations, with a wide loss and few points; the best first.
std::vector<BodyFit> rough_fits(const BodyView& view, const RoundedBody& body,
                                double place_points) {
  const Eigen::Vector3d center = likely_center(view, body);
  const auto rough = thinned(view, center, body.circumradius_m(), rough_points);
  std::vector<BodyFit> fits;
  for (int i = 0; i < rotations; ++i) {
    Eigen::Isometry3d start(spread_rotation(i));
    start.pretranslate(center);
    fits.push_back(
        descend(rough, body, {start, unknown_rad, place_points}, rough_width_m, rough_steps));
  }
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  return fits;
}

/// The body so turned, its surface where the middle of what is seen of it is.
Eigen::Isometry3d behind_the_middle(const BodyView& view, const RoundedBody& body,
                                    const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d middle = middle_of(view), ray = (middle - view.eye_m).normalized();
  const Eigen::Array3d across = (rotation.transpose() * ray).array().abs();
  const double behind_m = (body.half_extents_m().array() / across).minCoeff();
  Eigen::Isometry3d pose(rotation);
  pose.pretranslate(middle + behind_m * ray);
  return pose;
}

}  // namespace

Eigen::Matrix3d BodyFit::center_information() const {
  const Eigen::Matrix3d across = information.topRightCorner<3, 3>();
  return information.topLeftCorner<3, 3>() -
         across * information.bottomRightCorner<3, 3>().inverse() * across.transpose();
}

Eigen::Vector3d likely_center(const BodyView& view, const RoundedBody& body) {
  const Eigen::Vector3d middle = middle_of(view);
  const double behind = seen_depth * (body.radius_m + body.inner_m.mean());
  return middle + behind * (middle - view.eye_m).normalized();
}

BodyView thinned(const BodyView& view, const Eigen::Vector3d& center_m, double reach_m,
                 std::size_t most) {
  const Eigen::Vector3d eye = view.eye_m - center_m;
  std::vector<Eigen::Vector3f> passing;
  for (const auto& end : view.seen_past_m)
    if (passes(eye, end.cast<double>() - center_m, reach_m)) passing.push_back(end);
  return {view.eye_m,       some_of(view.on_m, most), some_of(passing, most),
          view.noise_ratio, view.looks_beside,        view.marked};
}

BodyFit fit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                 double rotation_sigma_rad) {
  const auto rough = descend(view, body, {start, rotation_sigma_rad}, rough_width_m, most_steps);
  return descend(view, body, {rough.camera_from_body, rotation_sigma_rad}, fine_width_m,
                 most_steps);
}

BodyFit refit_body(const BodyView& view, const RoundedBody& body, const Eigen::Isometry3d& start,
                   double rotation_sigma_rad) {
  return descend(view, body, {start, rotation_sigma_rad}, fine_width_m, most_steps);
}

std::vector<BodyFit> fits_anyhow(const BodyView& view, const RoundedBody& body,
                                 double place_points) {
  const auto refit = [&](const Eigen::Isometry3d& start) {
    return descend(view, body, {start, unknown_rad, place_points}, fine_width_m, most_steps);
  };
  auto fits = rough_fits(view, body, place_points);
  fits.resize(kept_starts);
  for (auto& fit : fits) fit = refit(fit.camera_from_body);
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  const Eigen::Matrix3d best = fits.front().camera_from_body.linear();
  for (const Eigen::Quaterniond& exchange : exchanges())
    fits.push_back(refit(behind_the_middle(view, body, best * exchange)));
  std::ranges::sort(fits, {}, &BodyFit::cost_m2);
  return fits;
}

BodyFit fit_body_anyhow(const BodyView& view, const RoundedBody& body) {
  return fits_anyhow(view, body, unknown_place_points).front();
}

}  // namespace touchtrace::label
