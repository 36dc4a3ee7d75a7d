#pragma once

#include <filesystem>
#include <memory>

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

/// A simulated recording whose images are rendered when they are read, the same as
/// simulate_recording() stores. Thread-safe; holds the motion of all clips, 2 MB each.
class RenderedScene {
 public:
  /// Simulates all clips. Throws like simulate_recording(). The Runtime must outlive it.
  RenderedScene(const SceneOptions& options, Runtime& runtime);
  ~RenderedScene();

  /// With clips, boxes, glove and stamps of the camera's frames.
  const Recording& recording() const;
  std::size_t background_frames() const;
  std::size_t board_views() const;
  RgbdFrame camera_frame(std::size_t index) const;
  RgbdFrame background(std::size_t index) const;
  RgbdFrame board_view(std::size_t index) const;

  /// Writes the recording with its truth and without images, the same as simulate_recording()
  /// without `runtime`.
  SimulationSummary write(const std::filesystem::path& output, bool overwrite,
                          Provenance provenance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchtrace::scene
