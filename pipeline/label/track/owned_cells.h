#pragma once

#include <set>
#include <vector>

#include "pipeline/label/observe/connected_cells.h"
#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

using CellIndices = std::vector<std::size_t>;

/// Position and visible size of a set of cells.
struct Place {
  Eigen::Vector3d centroid_m;
  double visible_fraction;  ///< area over that of a hand's disc
};

/// Cells of the hand's colour in one frame, each with the index of the body that owns it.
class OwnedCells {
 public:
  static constexpr int no_owner = -1;

  /// The segmenter must outlive this object.
  explicit OwnedCells(const Segmenter& segmenter) : segmenter_(segmenter) {}

  /// Finds cells of width `cell_m` within `radius_m` of a centre; none has an owner.
  void find(const Surface& surface, float cell_m, const Eigen::Vector3d& centre_m, double radius_m);

  /// Reassigns each cell of `owner` to the body of the nearest cell that a body owns.
  void give_to_nearest(int owner);

  CellIndices of(int owner) const;
  std::vector<CellIndices> components_of(int owner) const;
  /// Connected components if only the cells of `owner` were there.
  std::vector<CellIndices> parts_of(int owner) const;
  /// Sets of bodies that own cells of one component.
  std::set<std::set<std::size_t>> touching() const;
  /// Mean over the points.
  Eigen::Vector3d centroid_m(const CellIndices& indices) const;
  /// Area over that of a hand's disc; 0 without cells.
  double visible_fraction(const CellIndices& indices) const;
  Place place_of(const CellIndices& indices) const;
  /// Whether cells of both touch, also at corners.
  bool touch(const CellIndices& a, const CellIndices& b) const;
  /// Whether cells of both are nearer to each other than a distance.
  bool touch(const CellIndices& a, const CellIndices& b, double distance_m) const;

  std::vector<Cell> cells;
  std::vector<int> owners;  ///< [cells] negative: no body

 private:
  const Segmenter& segmenter_;
};

}  // namespace touchtrace::label
