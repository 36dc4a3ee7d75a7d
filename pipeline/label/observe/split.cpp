#include "pipeline/label/observe/split.h"

#include <algorithm>
#include <limits>

#include "pipeline/label/observe/connected_cells.h"

namespace touchtrace::label {
namespace {

constexpr float cell_m = 0.015f;  // points in neighbouring cells are connected
constexpr double max_extent_radii = 1.5, hand_reach_m = 0.12;
constexpr double max_object_extent_radii = 4.0;  // a long object and what touches it

using Indices = std::vector<std::size_t>;

std::vector<Indices> components_of(const Surface& surface, Body body) {
  std::vector<Indices> components;
  for (const auto& cell : connected_cells(surface, body, cell_m)) {
    components.resize(cell.component + 1);
    auto& points = components[cell.component];
    points.insert(points.end(), cell.points.begin(), cell.points.end());
  }
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

void remove_large_components(Surface& surface, double radius_m) {
  for (const auto& component : components_of(surface, Body::object))
    if (!fits_in(surface, component, max_object_extent_radii * radius_m))
      for (const auto i : component) surface[i].body = Body::rest;
}

}  // namespace touchtrace::label
