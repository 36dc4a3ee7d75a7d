#include "calib/board/chessboard_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "calib/board/board_detector.h"
#include "calib/board/chessboard.h"
#include "calib/board/reduced_image.h"
#include "calib/rgbd/calibrate.h"
#include "tests/calib/rendered_board.h"

namespace touchtrace {
namespace {

using testing::board_pose, testing::corner_rms_px;

const CalibrationTarget board_9x6{9, 6, 0.03}, board_8x6{8, 6, 0.03}, board_7x7{7, 7, 0.03};
const Eigen::Vector3d tilt(0.3, -0.2, 0.1);

/// Board with a white margin of one square. OpenCV begins with a light square if the board has one
/// at a corner.
cv::Mat draw(const CalibrationTarget& board) {
  const int square_px = int(std::lround(board.square_m * testing::print_px_per_m));
  cv::Mat drawing((board.rows + 3) * square_px, (board.columns + 3) * square_px, CV_8U,
                  cv::Scalar(255));
  for (int y = 0; y <= board.rows; ++y)
    for (int x = (y + board.columns + board.rows) % 2; x <= board.columns; x += 2)
      drawing(cv::Rect((x + 1) * square_px, (y + 1) * square_px, square_px, square_px)) = 0;
  return drawing;
}

GreyImage render(const CalibrationTarget& board, const Eigen::Isometry3d& pose) {
  return testing::render({draw(board), Eigen::Vector2d::Constant(2.0 * board.square_m)}, pose);
}

/// Detects the board in a full view and in one with this pose.
BoardObservations detect(const CalibrationTarget& board, const Eigen::Isometry3d& pose) {
  BoardDetector detector(board);
  detector.add({.name = "full"}, render(board, board_pose(board, tilt, {0.0, 0.0, 0.7})));
  detector.add({.name = "part"}, render(board, pose));
  return std::move(detector).finish();
}

struct PartialView {
  const char* name;
  CalibrationTarget board;
  Eigen::Vector3d angle_axis, centre_m;

  friend void PrintTo(const PartialView& value, std::ostream* stream) { *stream << value.name; }
};

class ChessboardParts : public ::testing::TestWithParam<PartialView> {};

/// The index of each corner is right: a wrong one is off by a square, 26 px or more.
TEST_P(ChessboardParts, CornersAreAccurateAndNumberedAsOnTheBoard) {
  const auto& [name, board, angle_axis, centre_m] = GetParam();
  const auto pose = board_pose(board, angle_axis, centre_m);
  const BoardObservations found = detect(board, pose);
  ASSERT_EQ(found.views.size(), 2u);
  const BoardView& part = found.views[1];
  EXPECT_GE(part.corners_px.size(), 12u);
  EXPECT_LT(int(part.corners_px.size()), board.num_corners());
  ASSERT_EQ(part.corner_ids.size(), part.corners_px.size());
  EXPECT_LT(corner_rms_px(board, pose, part.corners_px, part.corner_ids), 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Chessboard, ChessboardParts,
    ::testing::Values(PartialView{"TwoEnds", board_9x6, tilt, {0.2, 0.1, 0.5}},
                      PartialView{"QuarterTurn", board_9x6, {0.1, 0.2, 1.5}, {0.0, 0.16, 0.5}},
                      PartialView{"Symmetric", board_8x6, tilt, {0.18, 0.1, 0.5}},
                      PartialView{"Square", board_7x7, tilt, {0.16, 0.1, 0.5}},
                      PartialView{"OneEndAndAllColumns", board_8x6, tilt, {0.0, 0.16, 0.5}}),
    [](const auto& view) { return view.param.name; });

/// Lit from one side: OpenCV finds all corners only if it is not told how many there are.
TEST(ChessboardPart, WithAllCornersIsAFullView) {
  cv::Mat drawing = cv::max(draw(board_8x6), 20);
  for (int x = 0; x < drawing.cols; ++x)
    drawing.col(x) *= 0.15 + 0.85 * std::pow(double(x) / drawing.cols, 2);
  const auto pose = board_pose(board_8x6, tilt, {0.0, 0.0, 0.5});
  const GreyImage image =
      testing::render({drawing, Eigen::Vector2d::Constant(2.0 * board_8x6.square_m)}, pose);
  ASSERT_LT(find_chessboard(image, board_8x6).corners_px.size(), 48u);
  BoardDetector detector(board_8x6);
  EXPECT_EQ(detector.add({.name = "only"}, image), BoardFound::whole);
  const BoardObservations found = std::move(detector).finish();
  ASSERT_EQ(found.views.size(), 1u);
  std::vector<int> ids(48);
  std::iota(ids.begin(), ids.end(), 0);
  const auto& corners_px = found.views[0].corners_px;
  const double rms_px = corner_rms_px(board_8x6, pose, corners_px, ids);
  std::ranges::reverse(ids);  // half a turn
  // The darkest corners have a contrast of 16 grey levels, the noise is 1.
  EXPECT_LT(std::min(rms_px, corner_rms_px(board_8x6, pose, corners_px, ids)), 0.2);
}

TEST(ChessboardPart, IsSkippedWhereItFitsInSeveralPlaces) {
  const auto found = detect(board_9x6, board_pose(board_9x6, tilt, {0.0, 0.0, 0.17}));
  EXPECT_EQ(found.views.size(), 1u);
  ASSERT_EQ(found.skipped.size(), 1u);
  EXPECT_EQ(found.skipped[0].name, "part");
}

TEST(ChessboardPart, IsNotOfASmallerBoard) {
  const auto part =
      find_chessboard_part(render(board_9x6, board_pose(board_9x6, tilt, {0.0, 0.0, 0.6})));
  ASSERT_TRUE(part);
  EXPECT_EQ(part->corners_px.size(), 54u);
  EXPECT_EQ(possible_places(*part, board_9x6, {}).size(), 2u);  // half a turn apart
  EXPECT_TRUE(possible_places(*part, {8, 6, 0.03}, {}).empty());
  EXPECT_TRUE(possible_places(*part, {10, 6, 0.03}, {}).empty());  // the board ends after nine
}

TEST(Chessboard, CornersHaveTheSameOrderHoweverTheBoardIsTurned) {
  for (const auto& board : {board_9x6, board_8x6, board_7x7, CalibrationTarget{7, 6, 0.03}})
    for (const double turn_rad : {0.1, 1.6, 3.0, 4.6})
      for (const auto& find : {find_chessboard, find_chessboard_by_squares}) {
        SCOPED_TRACE(::testing::Message()
                     << board.columns << "x" << board.rows << ", " << turn_rad);
        const auto pose = board_pose(board, {0.3, -0.2, turn_rad}, {0.0, 0.0, 0.6});
        const auto corners = find(render(board, pose), board).corners_px;
        ASSERT_EQ(corners.size(), static_cast<std::size_t>(board.num_corners()));
        std::vector<int> ids(corners.size());
        std::iota(ids.begin(), ids.end(), 0);
        double rms_px = corner_rms_px(board, pose, corners, ids);
        std::ranges::reverse(ids);
        if (board.is_symmetric())
          rms_px = std::min(rms_px, corner_rms_px(board, pose, corners, ids));
        EXPECT_LT(rms_px, 0.05);
      }
}

TEST(Chessboard, LeavesOutACornerUnderGlare) {
  constexpr int under_glare = 20;
  const auto pose = board_pose(board_9x6, {0.3, -0.2, 0.1}, {0.0, 0.0, 0.6});
  GreyImage image = render(board_9x6, pose);
  const auto all = find_chessboard_by_squares(image, board_9x6).corners_px;
  ASSERT_EQ(all.size(), 54u);
  cv::Mat pixels(image.height, image.width, CV_8U, image.pixels.data());
  cv::circle(pixels,
             {int(std::lround(all[under_glare].x())), int(std::lround(all[under_glare].y()))}, 6,
             255, cv::FILLED);
  const auto [corners, ids] = find_chessboard_by_squares(image, board_9x6);
  ASSERT_EQ(corners.size(), 53u);
  EXPECT_EQ(std::ranges::find(ids, under_glare), ids.end());
  EXPECT_LT(corner_rms_px(board_9x6, pose, corners, ids), 0.05);
}

TEST(Chessboard, ItsSizeIsFound) {
  for (const auto& [columns, rows] :
       {std::pair(13, 9), std::pair(9, 6), std::pair(7, 7), std::pair(4, 3)}) {
    const CalibrationTarget board{columns, rows, 0.03};
    for (const double turn_rad : {0.1, 1.6}) {
      const auto size =
          find_board_size(render(board, board_pose(board, {0.3, -0.2, turn_rad}, {0.0, 0.0, 0.9})));
      ASSERT_TRUE(size) << columns;
      EXPECT_EQ(*size, (BoardSize{columns, rows}));
    }
  }
}

TEST(ChessboardPart, IsNotInAnImageWithoutABoard) {
  EXPECT_FALSE(find_chessboard_part({64, 48, std::vector<std::uint8_t>(64 * 48, 128)}));
  EXPECT_FALSE(find_chessboard_part({1, 1, {0}}));
  RandomStream random(1, "noise");
  GreyImage noise{160, 120, {}};
  for (int i = 0; i < 160 * 120; ++i)
    noise.pixels.push_back(static_cast<std::uint8_t>(random.uniform(0.0, 255.0)));
  EXPECT_FALSE(find_chessboard_part(noise));
}

TEST(ChessboardPart, FitsInPlacesThatAgreeWithEndsAndColours) {
  ChessboardPart part;
  for (int i = 0; i < 9; ++i) part.cells.push_back({i % 3, i / 3});
  part.corners_px.resize(9);
  const CalibrationTarget board{5, 4, 0.03};
  EXPECT_EQ(possible_places(part, board, {}).size(), 4u * 3u * 2u);
  EXPECT_EQ(possible_places(part, board, true).size(), 4u * 3u * 2u) << "colours are not known";
  part.is_main_dark = false;
  EXPECT_EQ(possible_places(part, board, true).size(), 4u * 3u);
  part.ends = {{0, {-1, 0}}, {3, {-1, 0}}, {0, {0, -1}}, {1, {0, -1}}};
  EXPECT_EQ(possible_places(part, board, {}).size(), 4u);
  part.is_main_dark = true;
  const auto places = possible_places(part, board, true);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0], (std::vector<int>{0, 1, 2, 5, 6, 7, 10, 11, 12}));
}

TEST(Chessboard, ColoursAreThoseOfMostCorners) {
  const Eigen::Vector3d facing(0.0, 0.0, 0.05);
  const GreyImage whole = render(board_9x6, board_pose(board_9x6, facing, {0.0, 0.0, 0.5}));
  auto corners = find_chessboard(whole, board_9x6).corners_px;
  ASSERT_EQ(corners.size(), 54u);
  const auto is_dark = is_corner_0_main_dark(whole, board_9x6, corners);
  ASSERT_TRUE(is_dark);
  // an image that shows nothing of the squares outside of corner 0
  const Eigen::Vector2i first = (corners[0] - Eigen::Vector2d(2.0, 2.0)).cast<int>();
  GreyImage cut{whole.width - first.x(), whole.height - first.y(), {}};
  for (int y = first.y(); y < whole.height; ++y) {
    const auto row = whole.pixels.begin() + y * whole.width;
    cut.pixels.insert(cut.pixels.end(), row + first.x(), row + whole.width);
  }
  for (auto& corner : corners) corner -= first.cast<double>();
  EXPECT_EQ(is_corner_0_main_dark(cut, board_9x6, corners), is_dark);
  std::ranges::reverse(corners);
  EXPECT_EQ(is_corner_0_main_dark(cut, board_9x6, corners), !*is_dark);
}

TEST(CalibrationTarget, CornersOnALineDetermineNoPose) {
  const CalibrationTarget board{9, 9, 0.03};
  const std::vector<int> row{0, 1, 2, 3, 4, 5, 6, 10};  // seven in a row and one below
  EXPECT_FALSE(can_determine_pose(row, board));
  EXPECT_FALSE(can_determine_pose({0, 10, 20, 30, 40, 50, 60, 70}, board));
  EXPECT_TRUE(can_determine_pose({0, 1, 2, 3, 4, 5, 9, 10}, board));
  EXPECT_TRUE(can_determine_pose({0, 9, 18, 27, 36, 45, 1, 10}, board));
  EXPECT_FALSE(can_determine_pose({0, 1, 9, 10}, board));
}

TEST(ReducedImage, IsReducedByItsFactorExactly) {
  GreyImage original{5184, 16, {}};
  original.pixels.assign(std::size_t(original.width) * original.height, 0);
  const int x = 5177, y = 7;  // the middle of a block of 5 x 5
  original.pixels[std::size_t(y) * original.width + x] = 255;
  const ReducedImage reduced(original);
  ASSERT_EQ(reduced.factor, 5);
  const auto brightest = std::ranges::max_element(reduced.image.pixels);
  const auto at = brightest - reduced.image.pixels.begin();
  EXPECT_EQ(at % reduced.image.width, x / 5);
  EXPECT_EQ(at / reduced.image.width, y / 5);
  EXPECT_EQ(*brightest, 10) << "255 / 25";
}

TEST(ChessboardPart, CalibratesFromPartialViews) {
  BoardDetector detector(board_9x6);
  const double sides[] = {-0.16, 0.0, 0.16};
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d turn(0.5 * ((i % 3) - 1) + 0.1, 0.5 * ((i / 3) % 2 ? 1 : -1), 0.02 * i);
    const Eigen::Vector3d place(sides[i % 3], sides[i / 3] * 0.7, 0.45 + 0.02 * i);
    detector.add({.name = "view " + std::to_string(i)},
                 render(board_9x6, board_pose(board_9x6, turn, place)));
  }
  const BoardObservations observed = std::move(detector).finish();
  EXPECT_GE(std::ranges::count_if(observed.views,
                                  [](const auto& view) { return view.corners_px.size() < 54; }),
            3);
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, 0.05);
  testing::expect_rendered_camera(found.color);
}

/// An edge blurred by a Gaussian of deviation s rises from 10 to 90 % over 2.56 s.
TEST(Chessboard, WidthOfEdgesIsThatOfTheBlur) {
  const Eigen::Vector3d facing(0.0, 0.0, 0.05);
  const GreyImage sharp = render(board_9x6, board_pose(board_9x6, facing, {0.0, 0.0, 0.5}));
  const auto corners = find_chessboard(sharp, board_9x6).corners_px;
  ASSERT_EQ(corners.size(), 54u);
  const double spacing_px = 600.0 * 0.03 / 0.5;
  EXPECT_LT(relative_edge_width(sharp, corners, board_9x6) * spacing_px, 2.0);
  GreyImage blurred = sharp;
  cv::Mat pixels(sharp.height, sharp.width, CV_8U, blurred.pixels.data());
  cv::GaussianBlur(pixels, pixels, {}, 4.0);
  EXPECT_NEAR(relative_edge_width(blurred, corners, board_9x6) * spacing_px, 2.56 * 4.0, 1.5);
}

}  // namespace
}  // namespace touchtrace
