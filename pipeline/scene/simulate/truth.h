#pragma once

#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/camera_model.h"

namespace touchtrace::scene {

inline constexpr double truth_rate_hz = 100.0;

/// Truth of calibration and clocks, without samples.
Truth start_truth(const SceneOptions& options, const RgbdCamera& camera, const CameraClock& clock);

/// Appends a clip's samples at truth_rate_hz and its events, in the colour camera's frame.
void append_truth(Truth& truth, const ClipMotion& motion, const ObjectSpec& object, int clip,
                  const Eigen::Isometry3d& color_from_world);

}  // namespace touchtrace::scene
