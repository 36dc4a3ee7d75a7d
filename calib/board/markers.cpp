#include "calib/board/markers.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <opencv2/aruco/charuco.hpp>

#include "calib/board/enlarged.h"
#include "calib/board/saddle.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr std::size_t fewest_corners = 8;
constexpr int least_radius_px = 2, most_radius_px = 10;
const cv::Point2f pixel_centre(0.5f, 0.5f);  // there interpolateCornersCharuco has (0, 0)

struct Named {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME id;
};

constexpr Named dictionaries[] = {
    {"4x4_50", cv::aruco::DICT_4X4_50},          {"4x4_100", cv::aruco::DICT_4X4_100},
    {"4x4_250", cv::aruco::DICT_4X4_250},        {"4x4_1000", cv::aruco::DICT_4X4_1000},
    {"5x5_50", cv::aruco::DICT_5X5_50},          {"5x5_100", cv::aruco::DICT_5X5_100},
    {"5x5_250", cv::aruco::DICT_5X5_250},        {"5x5_1000", cv::aruco::DICT_5X5_1000},
    {"6x6_50", cv::aruco::DICT_6X6_50},          {"6x6_100", cv::aruco::DICT_6X6_100},
    {"6x6_250", cv::aruco::DICT_6X6_250},        {"6x6_1000", cv::aruco::DICT_6X6_1000},
    {"7x7_50", cv::aruco::DICT_7X7_50},          {"7x7_100", cv::aruco::DICT_7X7_100},
    {"7x7_250", cv::aruco::DICT_7X7_250},        {"7x7_1000", cv::aruco::DICT_7X7_1000},
    {"original", cv::aruco::DICT_ARUCO_ORIGINAL}};

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  const auto row = std::ranges::find(dictionaries, name, &Named::name);
  if (row == std::end(dictionaries))
    throw usage_error(fmt::format("there is no dictionary of markers '{}'", name),
                      suggestion(name, marker_dictionaries()));
  return cv::aruco::getPredefinedDictionary(row->id);
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_of(const Chessboard& board) {
  const auto dictionary = dictionary_of(board.markers->dictionary);
  const int across = board.columns + 1, along = board.rows + 1;
  if (across * along / 2 > dictionary->bytesList.rows)
    throw usage_error(fmt::format("a board of {}x{} squares has more markers than '{}'", across,
                                  along, board.markers->dictionary),
                      "name the dictionary and the size that the board was printed with");
  if (!(board.markers->side_m < board.square_m))
    throw usage_error("the board's markers are no smaller than its squares",
                      "give the side of a marker with --marker-mm");
  return cv::aruco::CharucoBoard::create(across, along, static_cast<float>(board.square_m),
                                         static_cast<float>(board.markers->side_m), dictionary);
}

struct Found {
  std::vector<Eigen::Vector2d> corners_px;
  std::vector<int> ids;
};

/// By OpenCV, to some tenths of a pixel.
Found roughly_found(const GreyImage& image, const Chessboard& board) {
  const auto charuco = charuco_of(board);
  const EnlargedImage enlarged(image, usual_enlargement(image));
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  Found found;
  try {
    cv::aruco::detectMarkers(enlarged.pixels, charuco->dictionary, markers, ids);
    if (!ids.empty())
      cv::aruco::interpolateCornersCharuco(markers, ids, enlarged.pixels, charuco, corners,
                                           found.ids);
  } catch (const cv::Exception&) {
    return {};  // OpenCV gives up on some images that show no board
  }
  for (const auto& corner : corners)
    found.corners_px.push_back(enlarged.in_original(corner - pixel_centre));
  return found;
}

/// Enough of them, in two rows and two columns at least.
bool places_board(const Found& found, const Chessboard& board) {
  if (found.ids.size() < fewest_corners) return false;
  const auto differ = [&](auto coordinate) {
    const auto [least, most] = std::ranges::minmax(found.ids, {}, coordinate);
    return coordinate(least) != coordinate(most);
  };
  return differ([&](int i) { return i / board.columns; }) &&
         differ([&](int i) { return i % board.columns; });
}

/// How far around a corner no marker is, where the board is foreshortened most.
int free_radius_px(const Found& found, const Chessboard& board) {
  const auto n = static_cast<Eigen::Index>(found.ids.size());
  Eigen::Matrix2Xd on_board_m(2, n), in_image_px(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    on_board_m.col(i) = board.corner_m(found.ids[static_cast<std::size_t>(i)]).head<2>();
    in_image_px.col(i) = found.corners_px[static_cast<std::size_t>(i)];
  }
  on_board_m.colwise() -= on_board_m.rowwise().mean().eval();
  const Eigen::Matrix2d px_per_m =
      in_image_px * on_board_m.transpose() * (on_board_m * on_board_m.transpose()).inverse();
  const double gap_px = 0.5 * (board.square_m - board.markers->side_m) *
                        Eigen::JacobiSVD<Eigen::Matrix2d>(px_per_m).singularValues()[1];
  return std::clamp(static_cast<int>(gap_px), least_radius_px, most_radius_px);
}

}  // namespace

std::vector<std::string> marker_dictionaries() {
  std::vector<std::string> names;
  for (const Named& row : dictionaries) names.emplace_back(row.name);
  return names;
}

std::pair<std::vector<Eigen::Vector2d>, std::vector<int>> find_marked_corners(
    const GreyImage& image, const Chessboard& board) {
  const Found rough = roughly_found(image, board);
  if (!places_board(rough, board)) return {};
  const int radius_px = free_radius_px(rough, board);
  Found found;
  for (std::size_t i = 0; i < rough.ids.size(); ++i)
    if (const auto corner = saddle_point(image, rough.corners_px[i], radius_px)) {
      found.corners_px.push_back(*corner);
      found.ids.push_back(rough.ids[i]);
    }
  if (!places_board(found, board)) return {};
  return {found.corners_px, found.ids};
}

}  // namespace touchtrace
