#pragma once

#include "calib/camera/camera.h"
#include "pipeline/label/estimate/body_view.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Planes of a user's box around a whole body near `position_m`. Sides at the image border are left
/// out: the body may extend beyond them.
BoxPlanes box_planes(const Camera& color, const PixelBox& box, const Eigen::Vector3d& position_m);

/// Centre [px] of a box of whole pixels. Pixel (0, 0) has its centre at the origin.
inline Eigen::Vector2d centre_px(const PixelBox& box) {
  return {box.x + 0.5 * (box.width - 1), box.y + 0.5 * (box.height - 1)};
}

/// Whether a side of the box is at the image border.
bool touches_border(const PixelBox& box, const Camera& color);

}  // namespace touchtrace::label
