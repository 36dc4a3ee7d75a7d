#pragma once

#include <filesystem>

#include "engine/cl/runtime.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Contents of a simulated recording.
struct SimulationSummary {
  std::size_t clips = 0, dropped_clips = 0, glove_frames = 0, camera_frames = 0, board_views = 0;
  double wall_seconds = 0.0, cpu_seconds = 0.0;
};

/// Simulates all clips, renders the camera's images, and writes the recording with its truth.
/// `runtime` null: no camera frames, background or board. The physics of the next clips runs in
/// parallel to the rendering; memory holds a few clips and at most two images. Same options, same
/// bits on one device. Throws usage_error for an unknown activity, an object that the activity does
/// not accept, or an image width that is not a multiple of 16.
SimulationSummary simulate_recording(const SceneOptions& options, Runtime* runtime,
                                     const std::filesystem::path& output, bool overwrite,
                                     Provenance provenance);

}  // namespace touchtrace::scene
