#include "pipeline/scene/camera/ray_map.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/integer_math.h"

namespace touchtrace::scene {
namespace {

struct Range {
  float low = 1e9f, high = -1e9f;

  void include(float value) { low = std::min(low, value), high = std::max(high, value); }
};

void append_region(std::vector<float>& regions, const RayMap& map, const Camera& camera, int column,
                   int row, int rows, double margin_px) {
  Range x, y;
  const int last_row = std::min(row + rows, camera.height);
  for (int v = row; v < last_row; ++v)
    for (int u = column; u < column + RayMap::lanes; ++u) {
      const auto pixel = static_cast<std::size_t>(v) * camera.width + u;
      x.include(map.x[pixel]), y.include(map.y[pixel]);
    }
  const auto mx = static_cast<float>(margin_px / camera.fx),
             my = static_cast<float>(margin_px / camera.fy);
  regions.insert(regions.end(), {x.low - mx, x.high + mx, y.low - my, y.high + my});
}

}  // namespace

RayMap make_ray_map(const Camera& camera, double margin_px) {
  if (camera.width <= 0 || camera.height <= 0 || camera.width % RayMap::lanes != 0)
    throw usage_error(fmt::format("cannot render images of {}x{}", camera.width, camera.height),
                      fmt::format("use a width that is a multiple of {}", RayMap::lanes));
  RayMap map;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject({u, v});
      map.x.push_back(static_cast<float>(ray.x())), map.y.push_back(static_cast<float>(ray.y()));
    }
  map.tile_columns = camera.width / RayMap::lanes;
  map.tile_lines = ceil_div(camera.height, int{RayMap::tile_rows});
  const auto cover = [&](std::vector<float>& regions, int rows) {
    for (int row = 0; row < camera.height; row += rows)
      for (int column = 0; column < camera.width; column += RayMap::lanes)
        append_region(regions, map, camera, column, row, rows, margin_px);
  };
  cover(map.strips, 1);
  cover(map.tiles, RayMap::tile_rows);
  return map;
}

}  // namespace touchtrace::scene
