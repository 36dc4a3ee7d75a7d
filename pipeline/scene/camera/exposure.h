#pragma once

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

/// State at `time_s`, interpolated between the clip's samples; the first or last one outside.
SceneSample sample_at(const ClipMotion& motion, double time_s);

/// Room, person, hand and object during an exposure of `exposure_s` around `middle_s`.
Exposure expose(const ClipMotion& motion, const SceneOptions& options, double middle_s,
                double exposure_s);

/// Box that a user would draw around the solids in the colour image: their bounds, each side off by
/// up to 3 pixels.
PixelBox draw_box(const std::vector<Solid>& solids, const RgbdCamera& camera, std::uint64_t seed,
                  int clip, std::string_view target);

}  // namespace touchtrace::scene
