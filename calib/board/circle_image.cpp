#include "calib/board/circle_image.h"

#include <cmath>
#include <numbers>

#include "calib/matrix/decomposition.h"

namespace touchtrace {
namespace {

constexpr Eigen::Index min_circles = 12;  // twice the polynomials' coefficients
constexpr int num_boundary_points = 64, num_inversion_steps = 3;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

CircleImage::Terms CircleImage::terms(const Eigen::Vector2d& place_m) const {
  const Eigen::Vector2d p = (place_m - centre_m_) / unit_m_;
  return Terms(1.0, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y());
}

std::optional<CircleImage> CircleImage::fit(const TargetCorners& circles,
                                            const CalibrationTarget& target,
                                            const Eigen::Vector2d& centre_m) {
  const auto homography = LocalHomography::fit(circles, target, centre_m);
  if (!homography) return {};
  CircleImage result(*homography, centre_m, target.square_m);
  Eigen::MatrixX<double> places(circles.ids.size(), 6), residuals(circles.ids.size(), 2);
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < circles.ids.size(); ++i) {
    const Eigen::Vector2d place_m = target.corner_m(circles.ids[i]).head<2>();
    if (!((place_m - centre_m).norm() <= LocalHomography::reach * target.square_m)) continue;
    places.row(count) = result.terms(place_m).transpose();
    residuals.row(count++) = (circles.corners_px[i] - homography->image_of(place_m)).transpose();
  }
  if (count < min_circles) return result;
  const LeastSquares fit = least_squares(places.topRows(count), residuals.topRows(count));
  if (fit.rank == 6) result.distortion_px_ = fit.x.transpose();
  return result;
}

Eigen::Vector2d CircleImage::image_of(const Eigen::Vector2d& place_m) const {
  return homography_.image_of(place_m) + distortion_px_ * terms(place_m);
}

Eigen::Vector2d CircleImage::place_of(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d place_m = centre_m_;
  for (int i = 0; i < num_inversion_steps; ++i)
    place_m = homography_.place_of(pixel - distortion_px_ * terms(place_m));
  return place_m;
}

std::vector<Eigen::Vector2d> CircleImage::boundary_px(double radius_m) const {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < num_boundary_points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / num_boundary_points;
    points.push_back(
        image_of(centre_m_ + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
  }
  return points;
}

Eigen::Vector2d CircleImage::centroid_offset_px(double radius_m) const {
  const Eigen::Vector2d origin = image_of(centre_m_);
  const auto points = boundary_px(radius_m);
  double area = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d a = points[i] - origin, b = points[(i + 1) % points.size()] - origin;
    area += cross(a, b), moment += cross(a, b) * (a + b) / 3.0;
  }
  return moment / area;
}

Eigen::Matrix2d CircleImage::derivative() const {
  return homography_.derivative(centre_m_) + distortion_px_.middleCols<2>(1) / unit_m_;
}

}  // namespace touchtrace
