#pragma once

#include "calib/board/board_view.h"
#include "calib/board/markers.h"

namespace touchtrace {

/// Row of a grid of markers in which their numbers begin.
enum class FirstRow { top, bottom };

/// Place of a corner in a rectangular grid of square markers with space between them.
Eigen::Vector2d tag_corner_m(const CalibrationTarget& grid, int column, int row);

/// Throws usage_error for more markers than the dictionary has, or markers without space between
/// them.
void require_possible_tag_grid(const CalibrationTarget& grid);

/// Corners of the decoded markers that the grid has.
TargetCorners tag_corners(const DecodedMarkers& tags, const CalibrationTarget& grid,
                          FirstRow first_row);

/// False if most decoded markers that are one above the other in the grid are not so in the image.
bool lie_as_in_grid(const DecodedMarkers& tags, const CalibrationTarget& grid, FirstRow first_row);

/// Tags in a row of the grid that decoded tags show; nullopt if they show none.
std::optional<int> find_tags_in_row(const DecodedMarkers& tags, FirstRow first_row);

/// A grid with another number of markers in a row than asked for.
std::optional<OtherTarget> find_other_tag_columns(const DecodedMarkers& tags,
                                                  const CalibrationTarget& asked,
                                                  FirstRow first_row);

/// Markers with another space between them than asked for, by over 5 %.
std::optional<OtherTarget> find_other_tag_spacing(const std::vector<BoardView>& views,
                                                  const CalibrationTarget& asked);

}  // namespace touchtrace
