#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/label/estimate/body_view.h"
#include "pipeline/label/estimate/learn_shape.h"
#include "pipeline/label/observe/lift.h"
#include "pipeline/label/observe/observer.h"

namespace touchtrace::label {

/// Images of a recording by index. The functions must be thread-safe.
struct FrameSource {
  std::function<RgbdFrame(std::size_t)> camera_frame, background;
  std::size_t background_frames = 0;
  std::vector<std::size_t> masked_frames = {};  ///< camera frames with a mask, in increasing order
  /// The only body that the masks show; nullopt: both.
  std::optional<MaskValue> only_masked_body = std::nullopt;
};

/// Camera frames [first, first + count) of a clip, and the boxes drawn in one of them.
struct ClipFrames {
  std::size_t first = 0, count = 0;
  PixelBox hand_box, object_box;
  std::string object;
  std::size_t box_frame = 0;
  bool has_mask_boxes = false;  ///< boxes are around masks, no user drew them
  std::string problem = {};     ///< why the clip cannot be labelled; empty: it can

  bool has_boxes() const { return !hand_box.empty() && !object_box.empty(); }
  bool is_usable() const { return count > 0 && problem.empty(); }
};

/// Frames of a clip in the order of tracking: from the box frame to the clip's end or, backward, to
/// its beginning.
struct TrackingPass {
  const ClipFrames* clip;
  bool is_backward;

  std::size_t count() const {
    return is_backward ? clip->box_frame - clip->first + 1
                       : clip->first + clip->count - clip->box_frame;
  }
  std::size_t frame(std::size_t i) const {
    return is_backward ? clip->box_frame - i : clip->box_frame + i;
  }
};

/// What is learnt of a scene before tracking. Const methods are thread-safe; those that take an
/// object's name throw std::out_of_range for an object that no clip names.
struct SceneModel {
  std::shared_ptr<const Segmenter> segmenter;
  std::shared_ptr<const Observer> observer;
  std::optional<double> depth_noise_at_1m = std::nullopt;  ///< [m]; see depth_noise_at_1m()
  std::map<std::string, ObjectShape> object_shape = {};
  std::set<std::string> objects_with_hand_color = {};  ///< not separable from the hand by colour
  std::set<std::string> objects_with_rest_color = {};  ///< not separable from a sleeve by colour
  bool has_all_masks = false;                          ///< masks alone show the bodies
  bool has_some_masks = false;  ///< masks show the bodies in some frames, colours in the others
  /// The only body that masks show, while colours show the other one; nullopt: masks show both.
  std::optional<MaskValue> only_masked_body = std::nullopt;

  /// For an object of the hand's colour: reclassifies the parts that are apart from the hand near
  /// `hand_m` as object (split_from_hand).
  void split_object(Surface& surface, const std::string& object,
                    const Eigen::Vector3d& hand_m) const;
  /// Depth points [m, colour camera's frame] around a patch, for shape and pose fitting.
  /// surface_points: the patch; if `whole_object`, all of the object's points within `reach_m` of
  ///   its centroid, since a long object shows on both sides of the hand (not for
  ///   objects_with_hand_color and objects_with_rest_color).
  /// free_space_endpoints: points farther away or of other classes; rays to them do not enter the
  ///   object. Hand's and object's are moved 15 mm, a finger, along the ray. Those of the class
  ///   `rest` are not moved: they may be the object's rim.
  BodyView view_object(const RgbdFrame& frame, const std::string& object, const Patch& patch,
                       double reach_m, bool whole_object) const;
  /// Fraction of the depth pixels around a sphere's centre that measure nothing behind it; 1 if
  /// none measures. Near 1 for a sphere that is there but not seen.
  double occluded_fraction(const RgbdFrame& frame, const Eigen::Vector3d& centre_m,
                           double radius_m) const;
};

}  // namespace touchtrace::label
