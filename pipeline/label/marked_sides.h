#pragma once

#include "calib/camera/camera.h"
#include "pipeline/label/body_view.h"
#include "pipeline/recording/recording.h"

namespace touchtrace::label {

/// Of a box that was marked on all of a body near `place_m`; a side at the picture's border, past
/// which the body may go on, is not among them.
MarkedSides marked_sides(const Camera& color, const PixelBox& box, const Eigen::Vector3d& place_m);

/// Whether one of its sides is there.
bool is_cut_off(const PixelBox& box, const Camera& color);

}  // namespace touchtrace::label
