#pragma once

#include <filesystem>

#include "engine/cl/runtime.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// What a simulation left in the recording.
struct SimulationSummary {
  std::size_t clips = 0, dropped_clips = 0, glove_frames = 0, camera_frames = 0, board_views = 0;
  double wall_seconds = 0.0, cpu_seconds = 0.0;
};

/// Simulates every clip, renders what the camera sees of it, and writes the recording with its
/// truth. `runtime` null: no camera frames, background or board, for studies that need the glove
/// and truth only. The next clips' physics runs beside the rendering; memory holds a few clips and
/// no more than two images. Same options, same bits on one device. Throws usage_error for an
/// unknown activity or object, or an image width that is no multiple of 16.
SimulationSummary simulate_recording(const SceneOptions& options, Runtime* runtime,
                                     const std::filesystem::path& output, bool overwrite,
                                     Provenance provenance);

}  // namespace touchtrace::scene
