#pragma once

#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

/// The motion at `time_s`, between its samples; the first or last one outside of them.
SceneSample sample_at(const ClipMotion& motion, double time_s);

/// What the camera sees of a clip of `options` during an exposure of `exposure_s` around
/// `middle_s`: room, person, hand and object.
Exposure expose(const ClipMotion& motion, const SceneOptions& options, double middle_s,
                double exposure_s);

/// Where a user marks solids in the colour image: their bounds, each side off by up to 3 pixels.
PixelBox mark(const std::vector<Solid>& solids, const RgbdCamera& camera, std::uint64_t seed,
              int clip, std::string_view target);

}  // namespace touchtrace::scene
