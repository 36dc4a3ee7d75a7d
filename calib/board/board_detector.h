#pragma once

#include "calib/board/chessboard_part.h"

namespace touchtrace {

/// How much of the board an image shows.
enum class BoardFound { nothing, part, whole };

/// Detects the board in the images of one camera.
///
/// A view of a part of a plain chessboard is used if it fits in one place on the board: found by
/// the ends of the board that it shows, the colours of its squares (known from a full view) and
/// its size. Of two places half a turn apart on a symmetric board, it takes the one that is turned
/// by less than 90 degrees from the first view, like align_symmetric_views(). A part with all
/// corners of the board is a full view.
///
/// A place that is wrong by whole squares or quarter turns changes only the pose of the board: an
/// ideal board has the same corners there. It biases the warp and the deformation of the board, and
/// the place of its depth pixels, but not the intrinsics of the camera.
class BoardDetector {
 public:
  explicit BoardDetector(const CalibrationTarget& board);

  /// Adds a view with the corners that the image shows; `view` has the other members. All images
  /// have one size. A view of a part of a target with markers counts as whole.
  BoardFound add(BoardView view, const GreyImage& image);
  /// All views, those of a part of the board at the end.
  BoardObservations finish() &&;

 private:
  struct PartialView {
    BoardView view;
    ChessboardPart part;
  };
  /// Replaces the corners of a chessboard, of which some were left out, by all of them if they are
  /// found as a part.
  void complete(BoardView& view, const GreyImage& image) const;
  BoardFound add_whole(BoardView view, const GreyImage& image);
  BoardFound add_part(BoardView view, const GreyImage& image);
  void update_lit(const GreyImage& image);
  void place(BoardView view, const ChessboardPart& part);

  BoardObservations observations_;
  std::vector<PartialView> partial_views_;
  std::optional<bool> is_main_dark_;  ///< of the first full view of a plain chessboard
};

}  // namespace touchtrace
