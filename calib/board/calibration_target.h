#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace touchtrace {

struct BoardView;
struct CalibrationTarget;
struct GreyImage;

/// Corners of a target that an image shows.
struct TargetCorners {
  std::vector<Eigen::Vector2d> corners_px = {};
  std::vector<int> ids = {};  ///< [corners] indices; empty: all, in order
};

/// Another target than the one that was asked for.
struct OtherTarget {
  std::string seen;  ///< "no board of 9x6 inner corners but one of 8x5"
  std::string hint;  ///< how to ask for it
};

inline constexpr const char* any_dictionary = "any";

/// A kind of calibration target. Each is defined with its detector.
struct TargetKind {
  const char* name;
  const char* element;  ///< what a user counts, e.g. "tags"
  int element_corners;  ///< corners of an element in a row
  /// Dictionary of its markers; any_dictionary: the user's; nullptr: it has none.
  const char* dictionary = nullptr;
  /// Place of a corner in the target's frame.
  Eigen::Vector2d (*place_m)(const CalibrationTarget& target, int column, int row);
  /// Whether the target looks the same after half a turn, so that a view does not tell its order.
  bool (*is_symmetric)(const CalibrationTarget& target);
  TargetCorners (*find_corners)(const GreyImage& image, const CalibrationTarget& target);
  /// What an image without `asked` shows; nullptr: cannot tell.
  std::optional<OtherTarget> (*find_other)(const GreyImage& image,
                                           const CalibrationTarget& asked) = nullptr;
  /// What an image shows, if it shows a target of this kind; nullptr: cannot tell.
  std::optional<OtherTarget> (*recognize)(const GreyImage& image) = nullptr;
  /// What `views` show, if it has other proportions than `asked`; nullptr: cannot tell.
  std::optional<OtherTarget> (*find_other_proportions)(const std::vector<BoardView>& views,
                                                       const CalibrationTarget& asked) = nullptr;
};

extern const TargetKind chessboard_kind, charuco_kind, aprilgrid_kind, aruco_grid_kind,
    circles_kind, asymmetric_circles_kind;

/// All kinds. A new one is added here.
std::span<const TargetKind* const> target_kinds();

/// A target of any kind but `except` that an image shows. It may take seconds in large images.
std::optional<OtherTarget> recognize_target(const GreyImage& image, const TargetKind& except);

/// Flat calibration target by its corners: inner corners of a chessboard, four of each tag of a
/// grid of tags, or centres of circles. Corners are numbered along the rows. Frame: origin at
/// corner 0 (asymmetric circles, too), x along a row, y along a column, z = 0, metres.
struct CalibrationTarget {
  struct Markers {
    std::string dictionary;  ///< one of marker_dictionaries()
    double side_m;
  };

  int columns = 9, rows = 6;  ///< corners in each row and column; twice the tags
  /// Side of a square. Grids of tags: distance from tag to tag. Circles: distance of their centres.
  /// Asymmetric circles: distance of rows, half the distance in a row.
  double square_m = 0.025;
  std::optional<Markers> markers = std::nullopt;  ///< ChArUco, grids of tags
  const TargetKind* kind = &chessboard_kind;
  bool is_flat = false;  ///< its warp is not estimated

  bool is_symmetric() const { return kind->is_symmetric(*this); }
  int num_corners() const { return columns * rows; }
  Eigen::Vector3d corner_m(int index) const {
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
    corner.head<2>() = kind->place_m(*this, index % columns, index / columns);
    return corner;
  }
  /// Width and height of the rectangle from corner 0 to the last one.
  Eigen::Vector2d size_m() const { return corner_m(num_corners() - 1).head<2>(); }
  /// Basis of the board's warp, as in mrcal: a parabola in x and one in y, each 1 at the centre and
  /// 0 at the outer corners. A board with the coefficients `warp_m` has z = warp_basis . warp_m.
  Eigen::Vector2d warp_basis(const Eigen::Vector2d& on_board_m) const {
    const Eigen::Array2d place = 2.0 * on_board_m.array() / size_m().array() - 1.0;
    return 1.0 - place.square();
  }
};

/// Place of a corner of a square lattice.
Eigen::Vector2d square_lattice_m(const CalibrationTarget& target, int column, int row);

/// True for 8 corners or more, of which two or more are in each of two rows or of two columns: they
/// determine a pose.
bool can_determine_pose(const std::vector<int>& ids, const CalibrationTarget& target);

/// Best affine map [px/m] from the target to its image.
Eigen::Matrix2d image_scale_px_per_m(const TargetCorners& corners, const CalibrationTarget& target);

}  // namespace touchtrace
