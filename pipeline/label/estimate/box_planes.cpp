#include "pipeline/label/estimate/box_planes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchtrace::label {
namespace {

/// Standard deviation of a drawn side: 2 to 3 pixels of 640.
constexpr double side_sigma_rad = 0.0045;

/// Side of a box between two corners; sides go around the box clockwise.
struct Side {
  Eigen::Vector2d from, to;
  double border_px;  ///< distance from the image border
};

std::array<Side, 4> sides_of(const PixelBox& box, const Camera& color) {
  const double left = box.x, top = box.y, right = left + box.width, bottom = top + box.height;
  return {{{{left, top}, {right, top}, top},
           {{right, top}, {right, bottom}, color.width - right},
           {{right, bottom}, {left, bottom}, color.height - bottom},
           {{left, bottom}, {left, top}, left}}};
}

bool is_at_border(const Side& side, const Camera& color) {
  return !(side.border_px > side_sigma_rad * color.fx);
}

}  // namespace

BoxPlanes box_planes(const Camera& color, const PixelBox& box, const Eigen::Vector3d& position_m) {
  const double m_per_px = position_m.z() / color.fx;
  BoxPlanes planes{{},
                   side_sigma_rad * position_m.norm() / point_sigma_m,
                   0.5 * m_per_px * std::hypot(box.width, box.height) / std::numbers::sqrt2};
  if (box.empty()) return planes;
  for (const auto& side : sides_of(box, color)) {
    const Eigen::Vector3d outward =
        color.unproject(side.to).cross(color.unproject(side.from)).normalized();
    if (!is_at_border(side, color) && outward.allFinite()) planes.outward.push_back(outward);
  }
  return planes;
}

bool touches_border(const PixelBox& box, const Camera& color) {
  return std::ranges::any_of(sides_of(box, color),
                             [&](const Side& side) { return is_at_border(side, color); });
}

}  // namespace touchtrace::label
