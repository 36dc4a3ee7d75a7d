#pragma once

#include <vector>

#include "calib/camera/camera.h"

namespace touchtrace::scene {

/// Rays of a camera's pixels, and bounds of the rays of each tile of the image. Layouts:
/// kernels/render_color.cl.
struct RayMap {
  static constexpr int lanes = 16, tile_rows = 8;  ///< width (SIMD lanes) and height of a tile [px]

  std::vector<float> x, y;  ///< [height, width]: the ray of a pixel's centre is (x, y, 1)
  std::vector<float>
      strips;  ///< [height, tile_columns, 4]: x low, high, y low, high of a tile's row
  std::vector<float> tiles;  ///< [tile_lines, tile_columns, 4]: the same of whole tiles
  int tile_columns, tile_lines;
};

/// `margin_px`: largest distance of a ray from its pixel's centre. Throws usage_error unless the
/// width is a multiple of 16.
RayMap make_ray_map(const Camera& camera, double margin_px);

}  // namespace touchtrace::scene
