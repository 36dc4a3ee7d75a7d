#include "pipeline/label/box_centre.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"
#include "pipeline/label/estimate/box_planes.h"

namespace touchtrace::label {
namespace {

/// Standard deviation of a drawn box's centre: 8 pixels of 640.
constexpr double box_sigma_rad = 0.015;

/// Angle between a position and a box's centre.
double offset_rad(const Camera& color, const PixelBox& box, const Eigen::Vector3d& position_m) {
  const Eigen::Vector2d centre(box.x + 0.5 * (box.width - 1), box.y + 0.5 * (box.height - 1));
  return (position_m / position_m.z() - color.unproject(centre)).norm();
}

}  // namespace

double box_centre_sigma_m(const Camera& color, const std::string& object,
                          const std::vector<ClipFrames>& clips,
                          const std::vector<ClipTrack>& tracks) {
  std::vector<double> sigmas_m;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (clips[i].object != object || tracks[i].object.empty()) continue;
    const auto& boxed = tracks[i].object[clips[i].box_frame - clips[i].first];
    if (!boxed.found || boxed.follows_hand) continue;
    if (clips[i].has_mask_boxes || touches_border(clips[i].object_box, color)) continue;
    const double offset = offset_rad(color, clips[i].object_box, boxed.position_m),
                 square = offset * offset - box_sigma_rad * box_sigma_rad;
    sigmas_m.push_back(boxed.position_m.z() * std::sqrt(0.5 * std::max(0.0, square)));
  }
  return sigmas_m.empty() ? 0.0 : median(std::move(sigmas_m));
}

}  // namespace touchtrace::label
