#pragma once

#include <vector>

#include "calib/camera/camera.h"

namespace touchtrace::scene {

/// The rays of a camera's pixels, and what each tile of the image can see. Rows of pixels are
/// `lanes` vectors; kernels/render_color.cl gives the layouts.
struct RayMap {
  static constexpr int lanes = 16, tile_rows = 8;

  std::vector<float> x, y;  ///< [height, width]: the ray through a pixel's centre is (x, y, 1)
  std::vector<float>
      strips;  ///< [height, tile columns, 4]: x low, high, y low, high of a row of a tile
  std::vector<float> tiles;  ///< [tile rows, tile columns, 4]: the same of whole tiles
  int tile_columns, tile_lines;
};

/// `margin_px`: how far rays may leave their pixel's centre. Throws usage_error unless the width is
/// a multiple of 16.
RayMap make_ray_map(const Camera& camera, double margin_px);

}  // namespace touchtrace::scene
