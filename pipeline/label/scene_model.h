#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/label/color_classes.h"
#include "pipeline/label/surface.h"

namespace touchtrace::label {

/// The images of a recording, by index. Safe to call from many threads.
struct FrameSource {
  std::function<RgbdFrame(std::size_t)> camera_frame, background;
  std::size_t background_frames = 0;
};

/// A clip's camera frames, [first, first + count), and its boxes.
struct ClipFrames {
  std::size_t first = 0, count = 0;
  PixelBox hand_box, object_box;
  std::string object;
};

/// What is learnt of the scene before anything is followed.
struct SceneModel {
  Segmenter segmenter;
  float band_m = 0.0f;                         ///< nearer than this is hand, arm or object
  std::map<std::string, ColorClasses> colors;  ///< by object
  std::map<std::string, double> object_radius_m;

  /// The frame's surface in front of the band, told apart; coloured points may lie a little behind
  /// it.
  Surface see(const RgbdFrame& frame, const std::string& object) const;
};

/// Background from its frames, the band from the torso's depth over the recording, colours from the
/// clips' first frames, the object's radius from its silhouettes.
SceneModel learn_scene(const RgbdCalibration& calibration, const CameraInfo& camera,
                       const FrameSource& frames, const std::vector<ClipFrames>& clips);

}  // namespace touchtrace::label
