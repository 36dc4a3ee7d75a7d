#include "calib/board/marker_sides.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/board/interpolated_grey.h"
#include "calib/matrix/decomposition.h"

namespace touchtrace {
namespace {

constexpr double min_contrast = 20.0;  ///< [grey levels] white minus black
constexpr double step_px = 0.5;
constexpr double used_share = 0.6;  ///< of the free width: rough corners are off by a pixel
constexpr double min_reach_px = 1.5, max_reach_px = 5.0;
constexpr int min_profiles = 5, num_rounds = 2, num_intersection_steps = 3;

/// A side of a marker: a parabola over the line between two rough corners.
class Side {
 public:
  Side(const Eigen::Vector2d& from, const Eigen::Vector2d& to)
      : middle_(0.5 * (from + to)),
        half_length_px_(0.5 * (to - from).norm()),
        along_((to - from).normalized()),
        outwards_(along_.y(), -along_.x()) {}

  /// False if it has too little contrast.
  bool fit(const GreyImage& image, double reach_px) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    int num_profiles = 0;
    const double last_px = half_length_px_ - reach_px;
    for (double at_px = -last_px; at_px <= last_px; at_px += 1.0) {
      const double edge_px = edge(image, middle_ + at_px * along_, reach_px);
      if (!std::isfinite(edge_px)) continue;
      const double t = at_px / half_length_px_;
      const Eigen::Vector3d terms(1.0, t, t * t);
      normal += terms * terms.transpose(), right += edge_px * terms;
      ++num_profiles;
    }
    if (num_profiles < min_profiles || num_profiles < last_px) return false;
    parabola_ = solve_semidefinite(normal, right);
    return true;
  }

  /// Distance of a point from the parabola along outwards(), and its gradient.
  double distance_px(const Eigen::Vector2d& point, Eigen::RowVector2d& gradient) const {
    const Eigen::Vector2d offset = point - middle_;
    const double t = along_.dot(offset) / half_length_px_;
    gradient = outwards_.transpose() -
               (parabola_[1] + 2.0 * parabola_[2] * t) / half_length_px_ * along_.transpose();
    return outwards_.dot(offset) - parabola_.dot(Eigen::Vector3d(1.0, t, t * t));
  }

 private:
  /// Place of the edge from black to white in a profile: where a step would have the same area.
  /// NaN if the profile has too little contrast or leaves the image.
  double edge(const GreyImage& image, const Eigen::Vector2d& centre, double reach_px) const {
    const auto grey = [&](double out_px) {
      return interpolated_grey(image, centre + out_px * outwards_);
    };
    const double black = grey(-reach_px), white = grey(reach_px);
    if (!(white - black >= min_contrast)) return std::numeric_limits<double>::quiet_NaN();
    const int num_steps = static_cast<int>(std::lround(2.0 * reach_px / step_px));
    double white_px = 0.0;  // trapezoidal rule
    for (int i = 1; i < num_steps; ++i)
      white_px += (grey(-reach_px + i * step_px) - black) / (white - black) * step_px;
    return reach_px - white_px - 0.5 * step_px;
  }

  Eigen::Vector2d middle_;
  double half_length_px_;
  Eigen::Vector2d along_, outwards_;
  Eigen::Vector3d parabola_ = Eigen::Vector3d::Zero();
};

/// Where two sides meet, near `start_px`; by Newton's method.
Eigen::Vector2d intersection(const Side& a, const Side& b, const Eigen::Vector2d& start_px) {
  Eigen::Vector2d at = start_px;
  for (int i = 0; i < num_intersection_steps; ++i) {
    Eigen::RowVector2d gradient_a, gradient_b;
    const Eigen::Vector2d distances(a.distance_px(at, gradient_a), b.distance_px(at, gradient_b));
    Eigen::Matrix2d jacobian;
    jacobian << gradient_a, gradient_b;
    at -= jacobian.inverse() * distances;
  }
  return at;
}

std::optional<DecodedMarkers::Corners> refine_once(const GreyImage& image,
                                                   const DecodedMarkers::Corners& rough_px,
                                                   double reach_px) {
  std::vector<Side> sides;
  for (std::size_t k = 0; k < 4; ++k) {
    sides.emplace_back(rough_px[k], rough_px[(k + 1) % 4]);
    if (!sides.back().fit(image, reach_px)) return {};
  }
  DecodedMarkers::Corners corners_px;
  for (std::size_t k = 0; k < 4; ++k) {
    corners_px[k] = intersection(sides[(k + 3) % 4], sides[k], rough_px[k]);
    if (!((corners_px[k] - rough_px[k]).norm() <= reach_px)) return {};
  }
  return corners_px;
}

/// Height over the shortest side: what remains of a length perpendicular to a side.
double smallest_height_px(const DecodedMarkers::Corners& corners_px) {
  const auto across = [&](std::size_t a, std::size_t b) {
    const Eigen::Vector2d side = corners_px[(a + 1) % 4] - corners_px[a],
                          other = corners_px[b] - corners_px[a];
    return std::abs(side.x() * other.y() - side.y() * other.x()) / side.norm();
  };
  return std::min({across(0, 2), across(1, 3), across(2, 0), across(3, 1)});
}

}  // namespace

std::optional<DecodedMarkers::Corners> refine_by_sides(const GreyImage& image,
                                                       const DecodedMarkers::Corners& rough_px,
                                                       double free_sides) {
  const double steps = std::floor(used_share * free_sides * smallest_height_px(rough_px) / step_px),
               reach_px = std::clamp(step_px * steps, min_reach_px, max_reach_px);
  std::optional<DecodedMarkers::Corners> corners_px = rough_px;
  for (int round = 0; round < num_rounds && corners_px; ++round)
    corners_px = refine_once(image, *corners_px, reach_px);
  return corners_px;
}

}  // namespace touchtrace
