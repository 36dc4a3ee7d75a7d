#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "calib/board/calibration_target.h"
#include "calib/board/grey_image.h"
#include "calib/camera/image_grid.h"

namespace touchtrace {

/// Detected corners of one colour image, and its depth image. Pixel convention: Camera.
struct BoardView {
  std::string name;                              ///< file name, or "view 3"
  std::vector<Eigen::Vector2d> corners_px = {};  ///< [detected corners]
  std::vector<float> depth_m = {};   ///< [height, width] as measured; 0: invalid; may be empty
  std::vector<int> corner_ids = {};  ///< [detected corners] board indices; empty: 0, 1, 2, ...
  double color_time_s = 0.0, depth_time_s = 0.0;  ///< time stamps; both 0: unknown
  /// Width of the edges between black and white over the side of a square; NaN: unknown.
  double relative_edge_width = std::numeric_limits<double>::quiet_NaN();

  int corner_id(std::size_t detected) const {
    return corner_ids.empty() ? static_cast<int>(detected) : corner_ids[detected];
  }
};

struct SkippedImage {
  std::string name, why;
};

/// Input of a calibration. All images have one size.
struct BoardObservations {
  CalibrationTarget board;
  int width = 0, height = 0;  ///< [px]
  std::vector<BoardView> views;
  std::vector<std::string> views_without_board;  ///< names of images in which none was found
  std::vector<SkippedImage> skipped;             ///< images that were not looked at
  std::array<double, 4> depth_intrinsics{};      ///< factory fx, fy, cx, cy [px]; 0: unknown
  /// False where all images are black, as outside of the image circle of a fisheye.
  ImageGrid::Mask lit = ImageGrid::Mask::Constant(true);
};

}  // namespace touchtrace
