#pragma once

#include <filesystem>

#include "pipeline/label/preview/label_overlay.h"

namespace touchtrace::label {

/// Throws usage_error if the name of a video does not end with .mp4 or .avi, or if the file exists
/// and `overwrite` is false.
void require_preview_path(const std::filesystem::path& path, bool overwrite);

/// Writes a video of all camera frames with their labels (LabelOverlay), at the camera's rate:
/// MPEG-4 (.mp4) or Motion JPEG (.avi). Keeps one frame in memory. Throws failure if OpenCV cannot
/// write it.
void write_preview(const std::filesystem::path& path, const Recording& recording,
                   const FrameSource& frames, const RgbdCalibration& calibration,
                   const Labels& labels, bool overwrite);

}  // namespace touchtrace::label
