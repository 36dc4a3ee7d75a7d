#include "calib/board/circle_lattice.h"

#include <Eigen/LU>
#include <algorithm>

#include "calib/board/corner_lattice.h"

namespace touchtrace {
namespace {

constexpr std::size_t num_neighbours = 6;      ///< in which a strongly tilted grid has two sides
constexpr double max_prediction_error = 0.25;  ///< fraction of a square's side

using Points = std::vector<Eigen::Vector2d>;

/// Cell of a circle on the lattice of nearest neighbours, diagonal if the grid is asymmetric.
LatticeCell cell_of(const CalibrationTarget& target, int id) {
  const int column = id % target.columns, row = id / target.columns;
  if (target.kind != &asymmetric_circles_kind) return {column, row};
  const int x = 2 * column + row % 2;
  return {(row + x) / 2, (row - x) / 2};
}

LatticeCell min_cell(const std::vector<LatticeCell>& cells) {
  LatticeCell least = cells.front();
  for (const LatticeCell& cell : cells)
    least = {std::min(least[0], cell[0]), std::min(least[1], cell[1])};
  return least;
}

/// Blob nearest to `at_px`, if within `max_px`.
std::optional<Eigen::Vector2d> blob_at(const Points& blobs, const Eigen::Vector2d& at_px,
                                       double max_px) {
  const auto distance = [&](const Eigen::Vector2d& blob) { return (blob - at_px).norm(); };
  const auto nearest = std::ranges::min_element(blobs, {}, distance);
  return distance(*nearest) < max_px ? std::optional(*nearest) : std::nullopt;
}

void grow_circles(CornerLattice& lattice, const Points& blobs, std::size_t max_size) {
  for (std::size_t before = 0; before < lattice.size() && lattice.size() <= max_size;) {
    before = lattice.size();
    for (const auto& [cell, unused] : CornerLattice(lattice))
      for (const LatticeCell& step : lattice_steps) {
        if (lattice.contains(cell + step)) continue;
        const auto predicted = predict_corner(lattice, cell, step);
        if (!predicted) continue;
        const double max_px = max_prediction_error * predicted->min_side_px();
        if (const auto blob = blob_at(blobs, predicted->at_px, max_px))
          lattice[cell + step] = *blob;
      }
  }
}

/// The circles in the target's order, if the lattice has its shape in one of four orientations.
Points match(const CornerLattice& lattice, const CalibrationTarget& target) {
  if (lattice.size() != static_cast<std::size_t>(target.num_corners())) return {};
  for (int quarter_turns = 0; quarter_turns < 4; ++quarter_turns) {
    std::vector<LatticeCell> in_image, on_target;
    for (const auto& [cell, unused] : lattice) in_image.push_back(cell);
    for (int id = 0; id < target.num_corners(); ++id)
      on_target.push_back(turned(cell_of(target, id), quarter_turns));
    const LatticeCell shift = min_cell(in_image) - min_cell(on_target);
    Points ordered;
    for (const LatticeCell& cell : on_target)
      if (const auto circle = lattice.find(cell + shift); circle != lattice.end())
        ordered.push_back(circle->second);
    if (ordered.size() == on_target.size()) return ordered;
  }
  return {};
}

/// The blobs nearest to a blob, itself not counted.
Points neighbours(Points blobs, const Eigen::Vector2d& blob) {
  const std::size_t count = std::min(num_neighbours + 1, blobs.size());
  std::ranges::partial_sort(
      blobs, blobs.begin() + static_cast<std::ptrdiff_t>(count), {},
      [&](const Eigen::Vector2d& other) { return (other - blob).squaredNorm(); });
  return {blobs.begin() + 1, blobs.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

std::vector<Eigen::Vector2d> order_circles(const std::vector<Eigen::Vector2d>& blobs_px,
                                           const CalibrationTarget& target) {
  if (blobs_px.size() < static_cast<std::size_t>(target.num_corners())) return {};
  for (const Eigen::Vector2d& blob : blobs_px) {
    const Points near = neighbours(blobs_px, blob);
    for (const Eigen::Vector2d& x : near)
      for (const Eigen::Vector2d& y : near) {
        const Eigen::Vector2d x_px = x - blob, y_px = y - blob;
        const double side_px = std::min(x_px.norm(), y_px.norm());
        // Clockwise, by 30 to 150 degrees.
        if (!(x_px.x() * y_px.y() - x_px.y() * y_px.x() > 0.5 * x_px.norm() * y_px.norm()))
          continue;
        const auto opposite = blob_at(blobs_px, x + y_px, max_prediction_error * side_px);
        if (!opposite) continue;
        CornerLattice lattice{{{0, 0}, blob}, {{1, 0}, x}, {{0, 1}, y}, {{1, 1}, *opposite}};
        grow_circles(lattice, blobs_px, static_cast<std::size_t>(target.num_corners()));
        if (auto ordered = match(lattice, target); !ordered.empty()) return ordered;
      }
  }
  return {};
}

}  // namespace touchtrace
