#pragma once

#include "engine/base/figure.h"

namespace touchtrace::scene {

/// Rows of `touchtrace verify scene`: physics against closed forms, the statistics of clips, speed.
Verification verify_scene();

}  // namespace touchtrace::scene
