#pragma once

#include "pipeline/label/preview/label_overlay.h"

namespace touchtrace::label {

/// JPEG image of 12 camera frames with labels, evenly spread, and of the first frames of the
/// four longest flagged stretches: four in a row, in order of time. At most 1600 px wide and
/// 400 kB.
std::vector<std::uint8_t> contact_sheet_jpeg(const LabelOverlay& overlay, const FrameSource& frames,
                                             int num_threads);

}  // namespace touchtrace::label
