#pragma once

#include "engine/base/figure.h"

namespace touchtrace::scene {

/// Rows of `touchtrace verify scene`: physics against closed forms, the statistics of clips, speed.
Verification verify_scene();

/// Rows about the speed of the renderer on an activity's scene.
void verify_rendering(const std::string& activity, const std::function<void(Figure)>& emit);

}  // namespace touchtrace::scene
