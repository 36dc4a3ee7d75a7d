#include "calib/board/markers.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <opencv2/aruco.hpp>
#include <optional>

#include "calib/board/upscaled_image.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr double max_marker_error = 0.2;  ///< of a corner, over the side of a marker

struct DictionaryName {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME id;
};

constexpr DictionaryName dictionaries[] = {{"4x4_50", cv::aruco::DICT_4X4_50},
                                           {"4x4_100", cv::aruco::DICT_4X4_100},
                                           {"4x4_250", cv::aruco::DICT_4X4_250},
                                           {"4x4_1000", cv::aruco::DICT_4X4_1000},
                                           {"5x5_50", cv::aruco::DICT_5X5_50},
                                           {"5x5_100", cv::aruco::DICT_5X5_100},
                                           {"5x5_250", cv::aruco::DICT_5X5_250},
                                           {"5x5_1000", cv::aruco::DICT_5X5_1000},
                                           {"6x6_50", cv::aruco::DICT_6X6_50},
                                           {"6x6_100", cv::aruco::DICT_6X6_100},
                                           {"6x6_250", cv::aruco::DICT_6X6_250},
                                           {"6x6_1000", cv::aruco::DICT_6X6_1000},
                                           {"7x7_50", cv::aruco::DICT_7X7_50},
                                           {"7x7_100", cv::aruco::DICT_7X7_100},
                                           {"7x7_250", cv::aruco::DICT_7X7_250},
                                           {"7x7_1000", cv::aruco::DICT_7X7_1000},
                                           {"original", cv::aruco::DICT_ARUCO_ORIGINAL},
                                           {"apriltag_16h5", cv::aruco::DICT_APRILTAG_16h5},
                                           {"apriltag_25h9", cv::aruco::DICT_APRILTAG_25h9},
                                           {"apriltag_36h10", cv::aruco::DICT_APRILTAG_36h10},
                                           {"apriltag_36h11", cv::aruco::DICT_APRILTAG_36h11}};

cv::Ptr<cv::aruco::Dictionary> find_dictionary(const std::string& name) {
  const auto row = std::ranges::find(dictionaries, name, &DictionaryName::name);
  if (row == std::end(dictionaries))
    throw usage_error(fmt::format("unknown marker dictionary '{}'", name),
                      suggestion(name, marker_dictionaries()));
  return cv::aruco::getPredefinedDictionary(row->id);
}

/// Corners by id; nullopt of an id that is seen several times.
using MarkersById = std::map<int, std::optional<DecodedMarkers::Corners>>;

MarkersById decode_upscaled(const GreyImage& image, int factor,
                            const cv::Ptr<cv::aruco::Dictionary>& dictionary, int border_bits) {
  const UpscaledImage enlarged(image, factor);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  try {
    cv::aruco::detectMarkers(enlarged.pixels, dictionary, corners, ids, parameters);
  } catch (const cv::Exception&) {
    return {};  // thrown for some images without a marker
  }
  MarkersById markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    DecodedMarkers::Corners corners_px;
    for (std::size_t k = 0; k < 4; ++k) corners_px[k] = enlarged.to_original(corners[i][k]);
    const auto [entry, is_first] = markers.try_emplace(ids[i], corners_px);
    if (!is_first) entry->second.reset();
  }
  return markers;
}

}  // namespace

std::vector<std::string> marker_dictionaries() {
  std::vector<std::string> names;
  for (const DictionaryName& row : dictionaries) names.emplace_back(row.name);
  return names;
}

int dictionary_size(const std::string& dictionary) {
  return find_dictionary(dictionary)->bytesList.rows;
}

int bits_in_row(const std::string& dictionary) { return find_dictionary(dictionary)->markerSize; }

const DecodedMarkers::Corners* DecodedMarkers::find(int id) const {
  const auto found = std::ranges::find(ids, id);
  return found == ids.end() ? nullptr : &corners_px[static_cast<std::size_t>(found - ids.begin())];
}

DecodedMarkers decode_markers(const GreyImage& image, const std::string& dictionary,
                              int border_bits) {
  const auto known = find_dictionary(dictionary);
  const int factor = default_upscale_factor(image);
  MarkersById markers = decode_upscaled(image, factor, known, border_bits);
  // In noisy photographs more are found in the image as it is.
  if (factor > 1) markers.merge(decode_upscaled(image, 1, known, border_bits));
  DecodedMarkers decoded;
  for (const auto& [id, corners_px] : markers)
    if (corners_px) decoded.ids.push_back(id), decoded.corners_px.push_back(*corners_px);
  return decoded;
}

std::optional<LocalHomography> homography_of(const PlacedMarker& a, const PlacedMarker& b) {
  const std::array<cv::Point2d, 4> corner_steps{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::vector<cv::Point2d> places, pixels;
  for (const auto& [corners_px, place] : {a, b})
    for (std::size_t k = 0; k < 4; ++k) {
      places.push_back(cv::Point2d(place.x(), place.y()) + corner_steps[k]);
      pixels.emplace_back((*corners_px)[k].x(), (*corners_px)[k].y());
    }
  const auto homography = LocalHomography::fit(places, pixels);
  if (!homography) return {};
  const double side_px = 0.5 *
                         (((*a.corners_px)[0] - (*a.corners_px)[2]).norm() +
                          ((*b.corners_px)[0] - (*b.corners_px)[2]).norm()) /
                         std::numbers::sqrt2;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d predicted = homography->image_of({places[i].x, places[i].y});
    if (!((predicted - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm() <=
          max_marker_error * side_px))
      return {};
  }
  return homography;
}

}  // namespace touchtrace
