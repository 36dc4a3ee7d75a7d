#include "calib/board/tag_grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "calib/board/corner_lattice.h"
#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int max_tags_in_row = 24, min_pairs = 3;
constexpr double candidate_spacings[] = {0.15, 0.3, 0.5, 0.8};  ///< over the side of a tag
constexpr std::size_t min_pairs_for_spacing = 20;
/// Relative. Public photographs of two kalibr targets, one by a fisheye, show 0.301 and 0.302 for
/// 0.3.
constexpr double max_spacing_error = 0.05;

/// Decoded tags one above the other in a grid with so many tags in a row.
struct TagPairs {
  int in_row = 0, all = 0;
  int right = 0;  ///< pairs whose positions in the image agree

  bool agree() const { return 2 * right >= all; }
};

/// `spacing`: over the side of a tag.
TagPairs pairs_in_columns(const DecodedMarkers& tags, int in_row, double spacing,
                          FirstRow first_row) {
  const Eigen::Vector2d above(0.0, -1.0 - spacing);
  TagPairs pairs{in_row};
  for (std::size_t i = 0; i < tags.ids.size(); ++i)
    if (const auto* other =
            tags.find(tags.ids[i] + (first_row == FirstRow::bottom ? in_row : -in_row))) {
      ++pairs.all;
      if (homography_of({&tags.corners_px[i], {0.0, 0.0}}, {other, above})) ++pairs.right;
    }
  return pairs;
}

double spacing_of(const CalibrationTarget& grid) {
  return grid.square_m / grid.markers->side_m - 1.0;
}

/// Space between two tags in a row over their side, from their corners along a line: `corners_px`
/// at 0, 1, 1 + s and 2 + s. Their cross ratio is the same in each perspective. NaN if they cannot
/// be such corners.
double spacing_of(const std::array<Eigen::Vector2d, 4>& corners_px) {
  const auto distance = [&](std::size_t i, std::size_t k) {
    return (corners_px[k] - corners_px[i]).norm();
  };
  const double cross_ratio = distance(0, 2) * distance(1, 3) / (distance(1, 2) * distance(0, 3));
  return std::sqrt(cross_ratio / (cross_ratio - 1.0)) - 1.0;
}

void add_spacings(const BoardView& view, const CalibrationTarget& grid,
                  std::vector<double>& spacings) {
  std::vector<const Eigen::Vector2d*> corners(static_cast<std::size_t>(grid.num_corners()));
  for (std::size_t i = 0; i < view.corners_px.size(); ++i)
    corners[static_cast<std::size_t>(view.corner_id(i))] = &view.corners_px[i];
  for (int first = 0; first < grid.num_corners(); first += 2) {
    if (first % grid.columns + 4 > grid.columns) continue;
    const auto tags = std::span(corners).subspan(static_cast<std::size_t>(first), 4);
    if (std::ranges::find(tags, nullptr) != tags.end()) continue;
    if (const double s = spacing_of({*tags[0], *tags[1], *tags[2], *tags[3]}); std::isfinite(s))
      spacings.push_back(s);
  }
}

}  // namespace

Eigen::Vector2d tag_corner_m(const CalibrationTarget& grid, int column, int row) {
  return grid.square_m * Eigen::Vector2d(column / 2, row / 2) +
         grid.markers->side_m * Eigen::Vector2d(column % 2, row % 2);
}

void require_possible_tag_grid(const CalibrationTarget& grid) {
  const int tags = grid.num_corners() / 4, available = dictionary_size(grid.markers->dictionary);
  if (tags > available)
    throw usage_error(fmt::format("a grid of {}x{} tags needs {}; {} has {}", grid.columns / 2,
                                  grid.rows / 2, tags, grid.markers->dictionary, available),
                      "--columns and --rows count tags");
  if (!(grid.markers->side_m < grid.square_m))
    throw usage_error("there is no space between the tags of the grid",
                      "--tag-spacing is the space between tags over their side, e.g. 0.3");
}

TargetCorners tag_corners(const DecodedMarkers& tags, const CalibrationTarget& grid,
                          FirstRow first_row) {
  constexpr std::array<LatticeCell, 4> tag_cells{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const int in_row = grid.columns / 2;
  TargetCorners corners;
  for (std::size_t i = 0; i < tags.ids.size(); ++i) {
    if (tags.ids[i] >= grid.num_corners() / 4) continue;
    const int from_first = tags.ids[i] / in_row, column = tags.ids[i] % in_row,
              row = first_row == FirstRow::top ? from_first : grid.rows / 2 - 1 - from_first;
    for (std::size_t k = 0; k < 4; ++k) {
      corners.corners_px.push_back(tags.corners_px[i][k]);
      corners.ids.push_back((2 * row + tag_cells[k][1]) * grid.columns + 2 * column +
                            tag_cells[k][0]);
    }
  }
  return corners;
}

bool lie_as_in_grid(const DecodedMarkers& tags, const CalibrationTarget& grid, FirstRow first_row) {
  return pairs_in_columns(tags, grid.columns / 2, spacing_of(grid), first_row).agree();
}

std::optional<int> find_tags_in_row(const DecodedMarkers& tags, FirstRow first_row) {
  TagPairs best;
  for (const double spacing : candidate_spacings)
    for (int in_row = 2; in_row <= max_tags_in_row; ++in_row)
      if (const TagPairs pairs = pairs_in_columns(tags, in_row, spacing, first_row);
          pairs.right > best.right)
        best = pairs;
  return best.right >= min_pairs && best.agree() ? std::optional(best.in_row) : std::nullopt;
}

std::optional<OtherTarget> find_other_tag_columns(const DecodedMarkers& tags,
                                                  const CalibrationTarget& asked,
                                                  FirstRow first_row) {
  const auto in_row = find_tags_in_row(tags, first_row);
  if (!in_row || *in_row == asked.columns / 2) return {};
  return OtherTarget{
      fmt::format("no grid with {} tags in a row but one with {}", asked.columns / 2, *in_row),
      fmt::format("give --columns {}; --rows counts tags, too", *in_row)};
}

std::optional<OtherTarget> find_other_tag_spacing(const std::vector<BoardView>& views,
                                                  const CalibrationTarget& asked) {
  std::vector<double> spacings;
  for (const auto& view : views) add_spacings(view, asked, spacings);
  if (spacings.size() < min_pairs_for_spacing) return {};
  const double seen = median(std::move(spacings)), given = spacing_of(asked);
  if (!(std::abs(seen - given) > max_spacing_error * given)) return {};
  return OtherTarget{
      fmt::format("a grid with a space between tags of {:.3g} of their side, not {:.3g}", seen,
                  given),
      fmt::format("measure both, and give about --tag-spacing {:.2g}", seen)};
}

}  // namespace touchtrace
