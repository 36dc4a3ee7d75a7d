#pragma once

#include "calib/board/local_homography.h"

namespace touchtrace {

/// Map from the target [m] to the image [px] near a circle: a homography, and quadratic polynomials
/// for what lens distortion adds to it.
class CircleImage {
 public:
  /// Least-squares fit to the circles near `centre_m`; nullopt where LocalHomography has none.
  static std::optional<CircleImage> fit(const TargetCorners& circles,
                                        const CalibrationTarget& target,
                                        const Eigen::Vector2d& centre_m);

  Eigen::Vector2d image_of(const Eigen::Vector2d& place_m) const;
  /// Place on the target whose image is `pixel`; near the circle, where the polynomials are small.
  Eigen::Vector2d place_of(const Eigen::Vector2d& pixel) const;
  /// Polygon that is the image of a circle.
  std::vector<Eigen::Vector2d> boundary_px(double radius_m) const;
  /// Centroid of the image of a circle's area, less the image of its centre.
  Eigen::Vector2d centroid_offset_px(double radius_m) const;
  /// Derivative of image_of() at the centre [px/m].
  Eigen::Matrix2d derivative() const;

 private:
  using Terms = Eigen::Matrix<double, 6, 1>;

  CircleImage(const LocalHomography& homography, const Eigen::Vector2d& centre_m, double unit_m)
      : homography_(homography), centre_m_(centre_m), unit_m_(unit_m) {}
  Terms terms(const Eigen::Vector2d& place_m) const;

  LocalHomography homography_;
  Eigen::Vector2d centre_m_;
  double unit_m_;
  Eigen::Matrix<double, 2, 6> distortion_px_ = Eigen::Matrix<double, 2, 6>::Zero();
};

}  // namespace touchtrace
