#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "calib/board/marker_sides.h"
#include "calib/board/tag_grid.h"

namespace touchtrace {
namespace {

constexpr int border_bits = 1;

/// Markers in the orientation of OpenCV's dictionaries, and turned by half a turn, as AprilTag
/// prints its tags.
std::array<DecodedMarkers, 2> decode(const GreyImage& image, const std::string& dictionary) {
  const DecodedMarkers markers = decode_markers(image, dictionary, border_bits);
  DecodedMarkers turned = markers;
  for (auto& corners_px : turned.corners_px)
    std::rotate(corners_px.begin(), corners_px.begin() + 2, corners_px.end());
  return {markers, turned};
}

/// Leaves out markers whose sides are not clear.
DecodedMarkers refined(const GreyImage& image, const DecodedMarkers& rough,
                       const CalibrationTarget& grid) {
  const double space = grid.square_m / grid.markers->side_m - 1.0,
               bit = 1.0 / (bits_in_row(grid.markers->dictionary) + 2 * border_bits);
  DecodedMarkers markers;
  for (std::size_t i = 0; i < rough.ids.size(); ++i)
    if (const auto corners_px = refine_by_sides(image, rough.corners_px[i], std::min(space, bit)))
      markers.ids.push_back(rough.ids[i]), markers.corners_px.push_back(*corners_px);
  return markers;
}

std::optional<OtherTarget> find_other(const GreyImage& image, const CalibrationTarget& asked) {
  for (const auto& markers : decode(image, asked.markers->dictionary))
    if (auto other = find_other_tag_columns(markers, asked, FirstRow::top)) return other;
  return {};
}

std::optional<OtherTarget> recognize(const GreyImage& image) {
  for (const char* dictionary : common_dictionaries)
    for (const auto& markers : decode(image, dictionary))
      if (const auto in_row = find_tags_in_row(markers, FirstRow::top))
        return OtherTarget{
            fmt::format("a grid of {} markers with {} in a row", dictionary, *in_row),
            fmt::format(
                "give --target aruco-grid --markers {} --columns {}, and the number of --rows",
                dictionary, *in_row)};
  return {};
}

/// Returns the corners of the visible markers of a grid (cv::aruco::GridBoard): of one dictionary,
/// numbered along the rows from 0 at the upper left. Both are empty if they do not determine a
/// pose.
///
/// Frame: origin at the upper left corner of marker 0, x to the right, y down.
///
/// Throws usage_error for an unknown dictionary, more markers than it has, or markers without space
/// between them.
TargetCorners find_aruco_grid_corners(const GreyImage& image, const CalibrationTarget& grid) {
  require_possible_tag_grid(grid);
  for (const auto& markers : decode(image, grid.markers->dictionary)) {
    if (!lie_as_in_grid(markers, grid, FirstRow::top)) continue;
    TargetCorners corners = tag_corners(refined(image, markers, grid), grid, FirstRow::top);
    return can_determine_pose(corners.ids, grid) ? corners : TargetCorners{};
  }
  return {};
}

}  // namespace

const TargetKind aruco_grid_kind{
    .name = "aruco-grid",
    .element = "tags",
    .element_corners = 2,
    .dictionary = any_dictionary,
    .place_m = tag_corner_m,
    .is_symmetric = [](const CalibrationTarget&) { return false; },
    .find_corners = find_aruco_grid_corners,
    .find_other = find_other,
    .recognize = recognize,
    .find_other_proportions = find_other_tag_spacing,
};

}  // namespace touchtrace
