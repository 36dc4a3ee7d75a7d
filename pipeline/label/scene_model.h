#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/label/body_view.h"
#include "pipeline/label/color_classes.h"
#include "pipeline/label/learn_shape.h"
#include "pipeline/label/lift.h"
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
  double depth_noise_at_1m = 0.0;              ///< [m]; grows as depth squared
  float band_m = 0.0f;                         ///< nearer than this is hand, arm or object
  std::map<std::string, ColorClasses> colors;  ///< by object
  std::map<std::string, ObjectShape> object_shape;
  std::set<std::string> like_the_hand;  ///< objects that no colour tells from it

  /// The frame's surface in front of the band, told apart by colour; coloured points may lie a
  /// little behind it.
  Surface see(const RgbdFrame& frame, const std::string& object) const;
  /// Tells an object like the hand from it where it is apart from the one near `hand_m`.
  void split(Surface& surface, const std::string& object, const Eigen::Vector3d& hand_m) const;
  /// What the depth camera sees of the object and past it, within `reach_m` of the patch's middle;
  /// what is farther from it is not the object, whatever its colour. Rays to what has the colours
  /// of neither hand nor object end there: it may be the object's rim. Of the object, the patch or,
  /// where it is to be seen `whole`, all that has its colours: a long one shows on both sides of
  /// the hand.
  BodyView view_body(const RgbdFrame& frame, const std::string& object, const Patch& patch,
                     double reach_m, bool whole) const;
  /// Part of the rays to a sphere's middle that end before they would have passed it, 0..1: a
  /// sphere that is there and not seen is hidden.
  double hidden_part(const RgbdFrame& frame, const Eigen::Vector3d& center_m,
                     double radius_m) const;
};

}  // namespace touchtrace::label
