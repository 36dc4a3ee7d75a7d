#pragma once

#include <future>

#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/camera/camera_clock.h"
#include "pipeline/scene/camera/renderer.h"

namespace touchtrace::scene {

inline constexpr int background_frames = 15;

/// Renders the camera's images and appends them to a recording. A frame is stored while the next
/// one is rendered.
class Video {
 public:
  Video(Runtime& runtime, const RgbdCamera& camera, const CameraClock& clock,
        const SceneOptions& options, RecordingWriter& writer);

  /// Renders the recording's last clip: images to the writer, stamps and boxes to `recording`.
  void record_clip(const ClipMotion& motion, int clip, Recording& recording);
  /// Renders the empty room and the chessboard. Returns the number of board views, which is smaller
  /// than requested only if board_poses() finds fewer.
  std::size_t record_still_views(const BoardInfo& board);

 private:
  using Append = void (RecordingWriter::*)(const RgbdFrame&);
  void store(RgbdFrame frame, Append append);

  RgbdCamera camera_;
  CameraClock clock_;
  SceneOptions options_;
  RecordingWriter& writer_;
  Renderer renderer_;
  std::future<void> storing_;
};

}  // namespace touchtrace::scene
