#include "pipeline/label/observe/split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace touchtrace::label {
namespace {

constexpr float cell_m = 0.015f;  // points in neighbouring cells are connected
constexpr double max_extent_radii = 1.5, hand_reach_m = 0.12;

using Cell = std::array<int, 3>;
using Indices = std::vector<std::size_t>;

Cell cell_of(const SurfacePoint& point) {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis)
    cell[axis] =
        static_cast<int>(std::floor(point.position_m[static_cast<Eigen::Index>(axis)] / cell_m));
  return cell;
}

/// Removes the connected component of a cell from `cells` and returns its points.
Indices take_component(std::map<Cell, Indices>& cells, const Cell& first) {
  Indices component;
  std::vector<Cell> open{first};
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    const auto found = cells.find(cell);
    if (found == cells.end()) continue;
    component.insert(component.end(), found->second.begin(), found->second.end());
    cells.erase(found);
    for (int i = 0; i < 27; ++i)
      open.push_back({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
  }
  return component;
}

std::vector<Indices> components_of(const Surface& surface, Body body) {
  std::map<Cell, Indices> cells;
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (surface[i].body == body) cells[cell_of(surface[i])].push_back(i);
  std::vector<Indices> components;
  while (!cells.empty()) components.push_back(take_component(cells, Cell(cells.begin()->first)));
  return components;
}

double nearest_m(const Surface& surface, const Indices& component, const Eigen::Vector3d& to) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto i : component)
    nearest = std::min(nearest, (surface[i].position_m.cast<double>() - to).norm());
  return nearest;
}

bool fits_in(const Surface& surface, const Indices& component, double radius_m) {
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  for (const auto i : component)
    centroid += surface[i].position_m / static_cast<float>(component.size());
  return std::ranges::all_of(component, [&](std::size_t i) {
    return (surface[i].position_m - centroid).norm() < radius_m;
  });
}

}  // namespace

void split_from_hand(Surface& surface, const Eigen::Vector3d& hand_m, double radius_m,
                     std::size_t min_points) {
  const auto components = components_of(surface, Body::hand);
  if (components.size() < 2) return;
  const auto hand = std::ranges::max_element(components, {}, [&](const Indices& component) {
    return nearest_m(surface, component, hand_m) < hand_reach_m ? component.size() : 0;
  });
  for (const auto& component : components)
    if (&component != &*hand && component.size() >= min_points &&
        fits_in(surface, component, max_extent_radii * radius_m))
      for (const auto i : component) surface[i].body = Body::object;
}

}  // namespace touchtrace::label
