#include "pipeline/label/observe/connected_cells.h"

#include <cmath>
#include <cstdlib>
#include <map>

namespace touchtrace::label {
namespace {

using GridIndex = std::array<int, 3>;
using Grid = std::map<GridIndex, Cell>;

GridIndex index_of(const SurfacePoint& point, float cell_m) {
  GridIndex index;
  for (std::size_t axis = 0; axis < 3; ++axis)
    index[axis] =
        static_cast<int>(std::floor(point.position_m[static_cast<Eigen::Index>(axis)] / cell_m));
  return index;
}

Grid grid_of(const Surface& surface, Body body, float cell_m) {
  Grid grid;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface[i].body != body) continue;
    const GridIndex index = index_of(surface[i], cell_m);
    auto& cell = grid.try_emplace(index, Cell{Eigen::Vector3f::Zero(), {}, index}).first->second;
    cell.mean_m += surface[i].position_m;
    cell.points.push_back(i);
  }
  for (auto& [index, cell] : grid) cell.mean_m /= static_cast<float>(cell.points.size());
  return grid;
}

/// Moves the connected component of a cell from `grid` to `cells`.
void take_component(Grid& grid, const GridIndex& first, std::size_t component,
                    std::vector<Cell>& cells) {
  std::vector<GridIndex> open{first};
  while (!open.empty()) {
    const GridIndex index = open.back();
    open.pop_back();
    auto found = grid.extract(index);
    if (found.empty()) continue;
    found.mapped().component = component;
    cells.push_back(std::move(found.mapped()));
    for (int i = 0; i < 27; ++i)
      open.push_back({index[0] + i % 3 - 1, index[1] + i / 3 % 3 - 1, index[2] + i / 9 - 1});
  }
}

}  // namespace

bool touch(const Cell& a, const Cell& b) {
  return std::abs(a.index[0] - b.index[0]) <= 1 && std::abs(a.index[1] - b.index[1]) <= 1 &&
         std::abs(a.index[2] - b.index[2]) <= 1;
}

std::vector<Cell> connected_cells(const Surface& surface, Body body, float cell_m) {
  auto grid = grid_of(surface, body, cell_m);
  std::vector<Cell> cells;
  for (std::size_t component = 0; !grid.empty(); ++component)
    take_component(grid, GridIndex(grid.begin()->first), component, cells);
  return cells;
}

}  // namespace touchtrace::label
