#include "pipeline/label/track/box_centre.h"

#include <algorithm>
#include <cmath>

#include "engine/base/statistics.h"
#include "pipeline/label/estimate/box_planes.h"

namespace touchtrace::label {
namespace {

/// Standard deviation of a drawn box's centre in the plane z = 1: 8 pixels of 640.
constexpr double box_sigma = 0.015;

/// Distance of a position's projection from a box's centre, in the plane z = 1.
double normalized_offset(const Camera& color, const PixelBox& box,
                         const Eigen::Vector3d& position_m) {
  return (position_m / position_m.z() - color.unproject(centre_px(box))).norm();
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
    const double offset = normalized_offset(color, clips[i].object_box, boxed.position_m),
                 square = offset * offset - box_sigma * box_sigma;
    sigmas_m.push_back(boxed.position_m.z() * std::sqrt(0.5 * std::max(0.0, square)));
  }
  return sigmas_m.empty() ? 0.0 : median(std::move(sigmas_m));
}

}  // namespace touchtrace::label
