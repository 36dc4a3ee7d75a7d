#include "pipeline/label/observe/connected_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <unordered_map>

namespace touchtrace::label {
namespace {

using GridIndex = std::array<int, 3>;

/// The low bits of the indices: those of no two cells of one scene are the same.
struct GridHash {
  std::size_t operator()(const GridIndex& index) const {
    constexpr std::size_t bits = 21, mask = (std::size_t{1} << bits) - 1;
    std::size_t hash = 0;
    for (const int i : index) hash = (hash << bits) | (static_cast<std::size_t>(i) & mask);
    return hash;
  }
};

GridIndex index_of(const SurfacePoint& point, float cell_m) {
  GridIndex index;
  for (std::size_t axis = 0; axis < 3; ++axis)
    index[axis] =
        static_cast<int>(std::floor(point.position_m[static_cast<Eigen::Index>(axis)] / cell_m));
  return index;
}

/// Cells in the order of their indices, without components.
std::vector<Cell> filled_cells(const Surface& surface, Body body, float cell_m) {
  std::vector<Cell> cells;
  std::unordered_map<GridIndex, std::size_t, GridHash> place;
  std::size_t last = 0;  // neighbouring points are mostly in the same cell
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface[i].body != body) continue;
    const GridIndex index = index_of(surface[i], cell_m);
    if (cells.empty() || cells[last].index != index) {
      const auto [found, is_new] = place.try_emplace(index, cells.size());
      if (is_new) cells.push_back({Eigen::Vector3f::Zero(), {}, index});
      last = found->second;
    }
    cells[last].mean_m += surface[i].position_m;
    cells[last].points.push_back(i);
  }
  for (auto& cell : cells) cell.mean_m /= static_cast<float>(cell.points.size());
  std::ranges::sort(cells, {}, &Cell::index);
  return cells;
}

/// Disjoint sets. A set's root is its least member.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Sets of connected cells. Joins each cell with those of its 13 neighbours with smaller indices
/// that exist: three columns at x - 1, the column at y - 1, and the cell below.
Sets connected(const std::vector<Cell>& cells) {
  Sets sets(cells.size());
  for (const auto& [dx, dy] : {std::pair{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 0}}) {
    std::size_t first = 0;  // cell not below the neighbours in this column
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto [x, y, z] = cells[i].index;
      while (cells[first].index < GridIndex{x + dx, y + dy, z - 1}) ++first;
      for (std::size_t j = first; j < i && cells[j].index <= GridIndex{x + dx, y + dy, z + 1}; ++j)
        sets.join(i, j);
    }
  }
  return sets;
}

}  // namespace

bool touch(const Cell& a, const Cell& b) {
  return std::abs(a.index[0] - b.index[0]) <= 1 && std::abs(a.index[1] - b.index[1]) <= 1 &&
         std::abs(a.index[2] - b.index[2]) <= 1;
}

std::vector<Cell> connected_cells(const Surface& surface, Body body, float cell_m) {
  auto cells = filled_cells(surface, body, cell_m);
  auto sets = connected(cells);
  std::size_t count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    cells[i].component = sets.root(i) == i ? count++ : cells[sets.root(i)].component;
  std::ranges::stable_sort(cells, {}, &Cell::component);
  return cells;
}

}  // namespace touchtrace::label
