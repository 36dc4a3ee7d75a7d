#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// Chessboard or ChArUco board by its inner corners, which are numbered along the rows. Board
/// frame: origin at corner 0, x along a row, y along a column, z = 0, metres.
struct Chessboard {
  /// Markers in the white squares (ChArUco): a view may show a part of the board.
  struct Markers {
    std::string dictionary;  ///< one of marker_dictionaries()
    double side_m;
  };

  int columns = 9, rows = 6;  ///< inner corners in each row and column
  double square_m = 0.025;    ///< side of a square
  std::optional<Markers> markers = std::nullopt;

  /// Whether the board looks the same after half a turn, so that a view does not tell its order.
  bool is_symmetric() const { return !markers && (columns + rows) % 2 == 0; }
  int num_corners() const { return columns * rows; }
  Eigen::Vector3d corner_m(int index) const {
    return {square_m * (index % columns), square_m * (index / columns), 0.0};
  }
  /// Basis of the board's warp, as in mrcal: a parabola in x and one in y, each 1 at the centre and
  /// 0 at the outer corners. A board with the coefficients `warp_m` has z = warp_basis . warp_m.
  Eigen::Vector2d warp_basis(const Eigen::Vector2d& on_board_m) const {
    const Eigen::Vector2d side_m(square_m * (columns - 1), square_m * (rows - 1));
    const Eigen::Array2d place = 2.0 * on_board_m.array() / side_m.array() - 1.0;
    return 1.0 - place.square();
  }
};

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< [height, width]
};

/// Detected corners of one colour image, and its depth image. Pixel convention: Camera.
struct BoardView {
  std::string name;                         ///< file name, or "view 3"
  std::vector<Eigen::Vector2d> corners_px;  ///< [detected corners]
  std::vector<float> depth_m;        ///< [height, width] as measured; 0: invalid; may be empty
  std::vector<int> corner_ids = {};  ///< [detected corners] board indices; empty: 0, 1, 2, ...
  double color_time_s = 0.0, depth_time_s = 0.0;  ///< time stamps; both 0: unknown

  int corner_id(std::size_t detected) const {
    return corner_ids.empty() ? static_cast<int>(detected) : corner_ids[detected];
  }
};

struct SkippedImage {
  std::string name, why;
};

/// Input of a calibration. All images have one size.
struct BoardObservations {
  Chessboard board;
  int width = 0, height = 0;  ///< [px]
  std::vector<BoardView> views;
  std::vector<std::string> views_without_board;  ///< names of images in which none was found
  std::vector<SkippedImage> skipped;             ///< images that were not looked at
  std::array<double, 4> depth_intrinsics{};      ///< factory fx, fy, cx, cy [px]; 0: unknown
};

/// Returns the inner corners in the board's order, or {} if the image does not show all of them.
///
/// findChessboardCornersSB (Duda and Frese, BMVC 2018) on an image upscaled to about 1280 pixels:
/// on rendered 320x240 boards this lowers the corner error from 0.12 to 0.02 px. In an image of
/// more than 2000 pixels it looks on a reduced one and refines the corners by
/// refine_saddle_point().
std::vector<Eigen::Vector2d> find_chessboard(const GreyImage& image, const Chessboard& board);

/// Reverses the corners of views of a symmetric board that are turned by more than 90 degrees from
/// the first view, so that a corner of the board has one index in all views.
void align_symmetric_views(BoardObservations& observations);

/// Board of a size near `board`'s that the image shows, for an error message; quick and not
/// thorough.
std::optional<Chessboard> find_other_size(const GreyImage& image, const Chessboard& board);

}  // namespace touchtrace
