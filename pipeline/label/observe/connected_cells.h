#pragma once

#include <array>
#include <vector>

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Points of one class in one cube of a grid.
struct Cell {
  Eigen::Vector3f mean_m;
  std::vector<std::size_t> points;  ///< indices in the surface
  std::array<int, 3> index;         ///< of the cube in the grid
  std::size_t component = 0;  ///< counted from 0; the same in cells that touch, also at corners
};

/// Whether two cells touch, also at corners.
bool touch(const Cell& a, const Cell& b);

/// Cells of `cell_m` that contain points of `body`, in order of their components.
std::vector<Cell> connected_cells(const Surface& surface, Body body, float cell_m);

}  // namespace touchtrace::label
