#include "pipeline/label/track/owned_cells.h"

#include <algorithm>
#include <limits>
#include <map>

#include "pipeline/label/observe/lift.h"

namespace touchtrace::label {

void OwnedCells::find(const Surface& surface, float cell_m, const Eigen::Vector3d& centre_m,
                      double radius_m) {
  cells = connected_cells(surface, Body::hand, cell_m);
  std::erase_if(cells, [&](const Cell& cell) {
    return (cell.mean_m.cast<double>() - centre_m).norm() > radius_m;
  });
  owners.assign(cells.size(), no_owner);
}

std::set<std::set<std::size_t>> OwnedCells::touching() const {
  std::map<std::size_t, std::set<std::size_t>> owners_of;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (owners[i] != no_owner)
      owners_of[cells[i].component].insert(static_cast<std::size_t>(owners[i]));
  std::set<std::set<std::size_t>> groups;
  for (const auto& [component, group] : owners_of)
    if (group.size() > 1) groups.insert(group);
  return groups;
}

void OwnedCells::give_to_nearest(int owner) {
  const auto before = owners;
  for (const auto i : of(owner)) {
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t j = 0; j < cells.size(); ++j)
      if (const float distance_m = (cells[j].mean_m - cells[i].mean_m).norm();
          before[j] >= 0 && distance_m < least)
        least = distance_m, owners[i] = before[j];
  }
}

CellIndices OwnedCells::of(int owner) const {
  CellIndices result;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (owners[i] == owner) result.push_back(i);
  return result;
}

std::vector<CellIndices> OwnedCells::components_of(int owner) const {
  std::map<std::size_t, CellIndices> components;
  for (const auto i : of(owner)) components[cells[i].component].push_back(i);
  std::vector<CellIndices> result;
  for (auto& [component, indices] : components) result.push_back(std::move(indices));
  return result;
}

std::vector<CellIndices> OwnedCells::parts_of(int owner) const {
  std::vector<CellIndices> parts;
  for (const auto i : of(owner)) {
    CellIndices joined{i};
    std::erase_if(parts, [&](const CellIndices& part) {
      const bool is_joined = touch({i}, part);
      if (is_joined) joined.insert(joined.end(), part.begin(), part.end());
      return is_joined;
    });
    parts.push_back(std::move(joined));
  }
  return parts;
}

Eigen::Vector3d OwnedCells::centroid_m(const CellIndices& indices) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const auto i : indices) {
    const auto points = static_cast<double>(cells[i].points.size());
    sum += points * cells[i].mean_m.cast<double>(), count += points;
  }
  return sum / count;
}

Place OwnedCells::place_of(const CellIndices& indices) const {
  return {centroid_m(indices), visible_fraction(indices)};
}

double OwnedCells::visible_fraction(const CellIndices& indices) const {
  if (indices.empty()) return 0.0;
  double count = 0.0;
  for (const auto i : indices) count += static_cast<double>(cells[i].points.size());
  return count / segmenter_.disc_pixels(hand_disc_radius_m, centroid_m(indices).z());
}

bool OwnedCells::touch(const CellIndices& a, const CellIndices& b) const {
  return std::ranges::any_of(a, [&](std::size_t i) {
    return std::ranges::any_of(b, [&](std::size_t j) { return label::touch(cells[i], cells[j]); });
  });
}

bool OwnedCells::touch(const CellIndices& a, const CellIndices& b, double distance_m) const {
  return std::ranges::any_of(a, [&](std::size_t i) {
    return std::ranges::any_of(
        b, [&](std::size_t j) { return (cells[i].mean_m - cells[j].mean_m).norm() < distance_m; });
  });
}

}  // namespace touchtrace::label
