#pragma once

#include <optional>
#include <vector>

#include "pipeline/label/observe/lift.h"
#include "pipeline/label/track/owned_cells.h"
#include "pipeline/label/track/tracked_body.h"

namespace touchtrace::label {

/// Follows everything of the hand's colour through one pass: the hand and other bodies, such as the
/// other hand and the face, so that none of them is taken for the hand. A body has a motion filter
/// and its last visible surface, as cells. In the next frame a connected component of cells belongs
/// to the visible body whose surface, moved as its filter predicts, is nearest; a component that
/// contains several bodies is divided between them. A component that no visible body explains
/// belongs to the hidden body that most likely moved there, or is a new body.
///
/// Two assignments are compared where two bodies that were one component part while one of them was
/// hidden, and where a body appears that may be the hidden hand or another hidden body. Below a
/// likelihood ratio of 20 no patch is the hand's, until another body is seen elsewhere.
class OtherBodies {
 public:
  /// `depth_noise_at_1m` [m]: see depth_noise_at_1m(). The segmenter must outlive this object.
  OtherBodies(const Segmenter& segmenter, std::optional<double> depth_noise_at_1m)
      : segmenter_(segmenter),
        depth_noise_at_1m_(depth_noise_at_1m.value_or(0.0)),
        owned_(segmenter) {}

  /// First frame: what is outside both boxes, such as a bare arm, is other bodies'.
  void start(const Surface& surface, const PixelBox& hand_box, const PixelBox& object_box,
             const Patch& hand);
  /// Next frame, `seconds` later: changes the class of other bodies' points to `rest`.
  void exclude_from(Surface& surface, double seconds);
  /// Updates the bodies after the search for the hand in that frame. Returns whether the patch is
  /// the hand's beyond doubt.
  bool update(const std::optional<Patch>& hand);

 private:
  /// Components of cells that may be the hand's: those of its patch, and the large others.
  struct HandCells {
    CellIndices own;
    std::vector<CellIndices> apart;
  };

  void find_cells(const Surface& surface);
  void assign_to_visible();
  void assign_to_nearest();
  void share_components(const std::vector<std::vector<double>>& distances_m);
  void release_distant(std::size_t body);
  void assign_to_hidden();
  int hidden_owner(const CellIndices& component) const;
  void measure_others();
  HandCells hand_cells(const Patch& hand) const;
  /// Hidden body that may be at `position_m`, the nearest; null: none.
  TrackedBody* hidden_near(const Eigen::Vector3d& position_m);
  void add_body(const CellIndices& cells);

  const Segmenter& segmenter_;
  double depth_noise_at_1m_, seconds_ = 0.0;
  std::vector<TrackedBody> bodies_;  ///< the hand and the others
  OwnedCells owned_;                 ///< of the current frame; owners are indices of bodies_
};

}  // namespace touchtrace::label
