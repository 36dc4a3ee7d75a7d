#include "calib/board/local_homography.h"

#include <opencv2/calib3d.hpp>

namespace touchtrace {
namespace {

constexpr std::size_t min_corners = 6;

bool are_collinear(const std::vector<cv::Point2d>& points) {
  for (const cv::Point2d& a : points)
    for (const cv::Point2d& b : points)
      if (std::abs((a - points[0]).cross(b - points[0])) > 1e-9) return false;
  return true;
}

}  // namespace

std::optional<LocalHomography> LocalHomography::fit(const std::vector<cv::Point2d>& places,
                                                    const std::vector<cv::Point2d>& pixels) {
  if (places.size() < 4) return {};
  const cv::Mat h = cv::findHomography(places, pixels, 0);
  if (h.empty()) return {};
  return LocalHomography(cv::Matx33d(h));
}

std::optional<LocalHomography> LocalHomography::fit(const TargetCorners& corners,
                                                    const CalibrationTarget& target,
                                                    const Eigen::Vector2d& place_m) {
  std::vector<cv::Point2d> on_target, in_image;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const Eigen::Vector2d corner_m = target.corner_m(corners.ids[i]).head<2>();
    if (!((corner_m - place_m).norm() <= reach * target.square_m)) continue;
    on_target.emplace_back(corner_m.x() / target.square_m, corner_m.y() / target.square_m);
    in_image.emplace_back(corners.corners_px[i].x(), corners.corners_px[i].y());
  }
  if (on_target.size() < min_corners || are_collinear(on_target)) return {};
  const cv::Mat h = cv::findHomography(on_target, in_image, 0);
  if (h.empty()) return {};
  return LocalHomography(cv::Matx33d(h) *
                         cv::Matx33d::diag({1.0 / target.square_m, 1.0 / target.square_m, 1.0}));
}

Eigen::Vector2d LocalHomography::image_of(const Eigen::Vector2d& place_m) const {
  const cv::Vec3d p = h_ * cv::Vec3d(place_m.x(), place_m.y(), 1.0);
  return {p[0] / p[2], p[1] / p[2]};
}

Eigen::Vector2d LocalHomography::place_of(const Eigen::Vector2d& pixel) const {
  const cv::Vec3d p = inverse_ * cv::Vec3d(pixel.x(), pixel.y(), 1.0);
  return {p[0] / p[2], p[1] / p[2]};
}

Eigen::Matrix2d LocalHomography::derivative(const Eigen::Vector2d& place_m) const {
  const cv::Vec3d p = h_ * cv::Vec3d(place_m.x(), place_m.y(), 1.0);
  Eigen::Matrix2d d;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 2; ++column)
      d(row, column) = (h_(row, column) - p[row] / p[2] * h_(2, column)) / p[2];
  return d;
}

}  // namespace touchtrace
