#pragma once

#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

inline constexpr std::size_t background_frames = 15;

/// Images of the simulated camera, rendered when they are asked for: an image does not depend on
/// those before. Not thread-safe.
class Video {
 public:
  Video(Runtime& runtime, const RgbdCamera& camera, const CameraClock& clock,
        const SceneOptions& options, const BoardInfo& board);

  /// Appends the stamps of a clip's frames, and draws boxes in the first one. `clip` is the
  /// recording's last one. Returns the frames' sequence numbers.
  std::vector<std::uint64_t> append_frames(const ClipMotion& motion, int clip,
                                           Recording& recording) const;

  RgbdFrame camera_frame(const ClipMotion& motion, std::uint64_t sequence);
  /// The empty room.
  RgbdFrame background(std::size_t index);
  /// A chessboard in the empty room.
  RgbdFrame board_view(std::size_t index);
  /// Fewer than SceneOptions::board_views only if board_poses() finds fewer.
  std::size_t board_views() const { return board_poses_.size(); }

 private:
  RgbdCamera camera_;
  CameraClock clock_;
  SceneOptions options_;
  BoardInfo board_;
  std::vector<Eigen::Isometry3d> board_poses_;  ///< color_from_board
  Renderer renderer_;
};

}  // namespace touchtrace::scene
