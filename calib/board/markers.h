#pragma once

#include <array>
#include <vector>

#include "calib/board/board_view.h"
#include "calib/board/local_homography.h"

namespace touchtrace {

/// Markers that were decoded in an image, by increasing id. One that the image shows twice is left
/// out.
struct DecodedMarkers {
  using Corners = std::array<Eigen::Vector2d, 4>;  ///< [px] clockwise from the upper left one

  std::vector<int> ids;
  std::vector<Corners> corners_px;

  /// nullptr if it was not decoded.
  const Corners* find(int id) const;
};

/// Names of the dictionaries: "4x4_50", ..., "7x7_1000", "original", "apriltag_16h5", ...
std::vector<std::string> marker_dictionaries();

/// Dictionaries that contain most of the others of as many bits.
inline constexpr const char* common_dictionaries[] = {"4x4_1000", "5x5_1000", "6x6_1000",
                                                      "7x7_1000", "original", "apriltag_36h11"};

/// Decodes the markers of a dictionary, one of marker_dictionaries(). `border_bits`: width of the
/// black border. Throws usage_error for another dictionary.
DecodedMarkers decode_markers(const GreyImage& image, const std::string& dictionary,
                              int border_bits);

/// Number of markers in a dictionary.
int dictionary_size(const std::string& dictionary);

/// Bits in a row of a marker of a dictionary, without its border.
int bits_in_row(const std::string& dictionary);

/// A decoded marker and its place: that of its upper left corner [sides of a marker], y down.
struct PlacedMarker {
  const DecodedMarkers::Corners* corners_px;
  Eigen::Vector2d place;
};

/// Homography from places to the image, fitted to two markers near each other. nullopt if a corner
/// is off by more than a fifth of the side of a marker: then the places are not right.
std::optional<LocalHomography> homography_of(const PlacedMarker& a, const PlacedMarker& b);

}  // namespace touchtrace
