#pragma once

#include "engine/cl/launch.h"

namespace touchtrace {

/// A work-group's tile of a matrix product (kernels/gpu_tile.clh).
struct GpuTile {
  int rows, columns;

  std::size_t items() const { return static_cast<std::size_t>(rows * columns / 16); }
  void define(Defines& defines) const {
    defines["TILE_ROWS"] = std::to_string(rows);
    defines["TILE_COLUMNS"] = std::to_string(columns);
  }
};

}  // namespace touchtrace
