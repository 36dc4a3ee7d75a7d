#include "pipeline/label/track/box_centre.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// The object's position in a clip's box frame; nullopt where the box, which is around a mask or at
/// the image border, or the position does not show its centre.
std::optional<Eigen::Vector3d> boxed_position_m(const Camera& color, const ClipFrames& clip,
                                                const ClipTrack& track) {
  if (track.object.empty() || clip.has_mask_boxes || touches_border(clip.object_box, color))
    return std::nullopt;
  const auto& boxed = track.object[clip.box_frame - clip.first];
  if (!boxed.found || boxed.follows_hand) return std::nullopt;
  return boxed.position_m;
}

}  // namespace

bool is_outside_box(const Camera& color, const ClipFrames& clip, const ClipTrack& track) {
  const auto position_m = boxed_position_m(color, clip, track);
  if (!position_m) return false;
  const Eigen::Vector2d offset_px = color.project(*position_m) - centre_px(clip.object_box);
  return !(2.0 * std::abs(offset_px.x()) <= clip.object_box.width &&
           2.0 * std::abs(offset_px.y()) <= clip.object_box.height);
}

double box_centre_sigma_m(const Camera& color, const std::string& object,
                          const std::vector<ClipFrames>& clips,
                          const std::vector<ClipTrack>& tracks) {
  std::vector<double> sigmas_m;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (clips[i].object != object) continue;
    const auto position_m = boxed_position_m(color, clips[i], tracks[i]);
    if (!position_m) continue;
    const double offset = normalized_offset(color, clips[i].object_box, *position_m),
                 square = offset * offset - box_sigma * box_sigma;
    sigmas_m.push_back(position_m->z() * std::sqrt(0.5 * std::max(0.0, square)));
  }
  return sigmas_m.empty() ? 0.0 : median(std::move(sigmas_m));
}

}  // namespace touchtrace::label
