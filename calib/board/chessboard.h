#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// A chessboard by its inner corners. Board frame: x along the columns, y along the rows, z = 0,
/// metres; corner 0 is the origin, corners run along a row first.
struct Chessboard {
  /// In the white squares, so that a part of the board suffices: a ChArUco board.
  struct Markers {
    std::string dictionary;  ///< one of marker_dictionaries()
    double side_m;
  };

  int columns = 9, rows = 6;
  double square_m = 0.025;
  std::optional<Markers> markers = std::nullopt;

  int corners() const { return columns * rows; }
  Eigen::Vector3d corner_m(int index) const {
    return {square_m * (index % columns), square_m * (index / columns), 0.0};
  }
  /// A warped board bulges by warp_shape . warp [m] along z, mrcal's model: a parabola in each
  /// direction that is 1 in the middle and 0 at the outer corners.
  Eigen::Vector2d warp_shape(const Eigen::Vector2d& on_board_m) const {
    const Eigen::Vector2d side_m(square_m * (columns - 1), square_m * (rows - 1));
    const Eigen::Array2d place = 2.0 * on_board_m.array() / side_m.array() - 1.0;
    return 1.0 - place.square();
  }
};

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< [height, width]
};

/// What one image pair shows of the board.
struct BoardView {
  std::string name;                         ///< file name, or "view 3"
  std::vector<Eigen::Vector2d> corners_px;  ///< [corners that are seen], colour image
  std::vector<float>
      depth_m;  ///< [height, width] as measured, depth image; 0: no measurement; may be empty
  std::vector<int> shown = {};  ///< which of the board's corners; empty: all, in their order
  double color_time_s = 0.0, depth_time_s = 0.0;  ///< stamps; both 0 where there are none

  int corner(std::size_t seen) const {
    return shown.empty() ? static_cast<int>(seen) : shown[seen];
  }
};

/// Everything that a calibration starts from; all images have one size.
struct BoardObservations {
  Chessboard board;
  int width = 0, height = 0;
  std::vector<BoardView> views;
  std::vector<std::string> views_without_board;
  std::array<double, 4> depth_intrinsics{};  ///< factory fx, fy, cx, cy [px]; 0: unknown
};

/// The inner corners in the order of the board, or nothing if the image does not show all of them.
///
/// findChessboardCornersSB (Duda and Frese, BMVC 2018) on an image enlarged to about 1280 pixels:
/// on rendered 320x240 boards that lowers the corners' error from 0.12 to 0.02 px.
std::vector<Eigen::Vector2d> find_chessboard(const GreyImage& image, const Chessboard& board);

/// Looks for the board in `image` and adds the view to those with or to those without a board.
void add_view(BoardObservations& observations, std::string name, const GreyImage& image,
              std::vector<float> depth_m = {});

}  // namespace touchtrace
