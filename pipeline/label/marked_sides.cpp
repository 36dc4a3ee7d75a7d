#include "pipeline/label/marked_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchtrace::label {
namespace {

/// Deviation of a side that somebody drew: 2 to 3 pixels of 640.
constexpr double side_sigma_rad = 0.0045;

/// From one corner of a box to the next, around it.
struct Side {
  Eigen::Vector2d from, to;
  double border_px;  ///< how far it is from the picture's border
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

MarkedSides marked_sides(const Camera& color, const PixelBox& box, const Eigen::Vector3d& place_m) {
  const double m_per_px = place_m.z() / color.fx;
  MarkedSides marked{{},
                     side_sigma_rad * place_m.norm() / point_sigma_m,
                     0.5 * m_per_px * std::hypot(box.width, box.height) / std::numbers::sqrt2};
  if (box.empty()) return marked;
  for (const auto& side : sides_of(box, color)) {
    const Eigen::Vector3d outward =
        color.unproject(side.to).cross(color.unproject(side.from)).normalized();
    if (!is_at_border(side, color) && outward.allFinite()) marked.outward.push_back(outward);
  }
  return marked;
}

bool is_cut_off(const PixelBox& box, const Camera& color) {
  return std::ranges::any_of(sides_of(box, color),
                             [&](const Side& side) { return is_at_border(side, color); });
}

}  // namespace touchtrace::label
