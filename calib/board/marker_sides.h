#pragma once

#include <optional>

#include "calib/board/board_view.h"
#include "calib/board/markers.h"

namespace touchtrace {

/// Refines the corners of a marker: a parabola is fitted to each side of its black border, and the
/// corners are where they meet. Blur moves corners of a dark square inwards, but not its sides.
/// `free_sides`: distance from each side without other edges: width of the black border or of the
/// white margin, the smaller [marker sides].
/// nullopt if a side has no contrast, or is not within the image.
std::optional<DecodedMarkers::Corners> refine_by_sides(const GreyImage& image,
                                                       const DecodedMarkers::Corners& rough_px,
                                                       double free_sides);

}  // namespace touchtrace
