#include "calib/board/charuco.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <opencv2/aruco/charuco.hpp>

#include "calib/board/saddle.h"
#include "calib/board/upscaled_image.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr int min_radius_px = 2, max_radius_px = 10;
/// interpolateCornersCharuco puts (0, 0) at the corner of a pixel.
const cv::Point2f pixel_centre(0.5f, 0.5f);

struct DictionaryName {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME id;
};

constexpr DictionaryName dictionaries[] = {
    {"4x4_50", cv::aruco::DICT_4X4_50},          {"4x4_100", cv::aruco::DICT_4X4_100},
    {"4x4_250", cv::aruco::DICT_4X4_250},        {"4x4_1000", cv::aruco::DICT_4X4_1000},
    {"5x5_50", cv::aruco::DICT_5X5_50},          {"5x5_100", cv::aruco::DICT_5X5_100},
    {"5x5_250", cv::aruco::DICT_5X5_250},        {"5x5_1000", cv::aruco::DICT_5X5_1000},
    {"6x6_50", cv::aruco::DICT_6X6_50},          {"6x6_100", cv::aruco::DICT_6X6_100},
    {"6x6_250", cv::aruco::DICT_6X6_250},        {"6x6_1000", cv::aruco::DICT_6X6_1000},
    {"7x7_50", cv::aruco::DICT_7X7_50},          {"7x7_100", cv::aruco::DICT_7X7_100},
    {"7x7_250", cv::aruco::DICT_7X7_250},        {"7x7_1000", cv::aruco::DICT_7X7_1000},
    {"original", cv::aruco::DICT_ARUCO_ORIGINAL}};

cv::Ptr<cv::aruco::Dictionary> find_dictionary(const std::string& name) {
  const auto row = std::ranges::find(dictionaries, name, &DictionaryName::name);
  if (row == std::end(dictionaries))
    throw usage_error(fmt::format("unknown marker dictionary '{}'", name),
                      suggestion(name, marker_dictionaries()));
  return cv::aruco::getPredefinedDictionary(row->id);
}

cv::Ptr<cv::aruco::CharucoBoard> make_charuco_board(const CalibrationTarget& board) {
  const auto dictionary = find_dictionary(board.markers->dictionary);
  const int squares_x = board.columns + 1, squares_y = board.rows + 1;
  if (squares_x * squares_y / 2 > dictionary->bytesList.rows)
    throw usage_error(fmt::format("a board of {}x{} squares needs {} markers; '{}' has {}",
                                  squares_x, squares_y, squares_x * squares_y / 2,
                                  board.markers->dictionary, dictionary->bytesList.rows),
                      "use the dictionary and the size that the board was printed with");
  if (!(board.markers->side_m < board.square_m))
    throw usage_error(fmt::format("a marker of {:g} mm is not smaller than a square of {:g} mm",
                                  1e3 * board.markers->side_m, 1e3 * board.square_m),
                      "set the side of a marker with --marker-mm");
  return cv::aruco::CharucoBoard::create(squares_x, squares_y, static_cast<float>(board.square_m),
                                         static_cast<float>(board.markers->side_m), dictionary);
}

/// OpenCV's detection, accurate to some tenths of a pixel.
TargetCorners detect_corners(const GreyImage& image, const CalibrationTarget& board) {
  const auto charuco = make_charuco_board(board);
  const UpscaledImage enlarged(image, default_upscale_factor(image));
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  TargetCorners found;
  try {
    cv::aruco::detectMarkers(enlarged.pixels, charuco->dictionary, markers, ids);
    if (!ids.empty())
      cv::aruco::interpolateCornersCharuco(markers, ids, enlarged.pixels, charuco, corners,
                                           found.second);
  } catch (const cv::Exception&) {
    return {};  // thrown for some images without a board
  }
  for (const auto& corner : corners)
    found.first.push_back(enlarged.to_original(corner - pixel_centre));
  return found;
}

/// Radius around a corner that holds no marker, in the direction of the strongest foreshortening.
int marker_free_radius_px(const TargetCorners& found, const CalibrationTarget& board) {
  const Eigen::Matrix2d px_per_m = image_scale_px_per_m(found, board);
  const double gap_px = 0.5 * (board.square_m - board.markers->side_m) *
                        Eigen::JacobiSVD<Eigen::Matrix2d>(px_per_m).singularValues()[1];
  return std::clamp(static_cast<int>(gap_px), min_radius_px, max_radius_px);
}

}  // namespace

std::vector<std::string> marker_dictionaries() {
  std::vector<std::string> names;
  for (const DictionaryName& row : dictionaries) names.emplace_back(row.name);
  return names;
}

TargetCorners find_charuco_corners(const GreyImage& image, const CalibrationTarget& board) {
  const TargetCorners rough = detect_corners(image, board);
  const auto& [rough_px, ids] = rough;
  if (!determine_pose(ids, board)) return {};
  const int radius_px = marker_free_radius_px(rough, board);
  TargetCorners found;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (const auto corner = refine_saddle_point(image, rough_px[i], radius_px)) {
      found.first.push_back(*corner);
      found.second.push_back(ids[i]);
    }
  return determine_pose(found.second, board) ? found : TargetCorners{};
}

const TargetKind charuco_kind{"charuco", square_lattice_m,
                              [](const CalibrationTarget&) { return false; }, find_charuco_corners};

}  // namespace touchtrace
