#include "pipeline/acquire/board_size.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/acquire/decode_image.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::put, testing::TemporaryFolder;

/// Chessboard that faces the camera, turned by 4 degrees.
cv::Mat photograph(const BoardSize& size) {
  constexpr int square_px = 30, margin_px = 40;
  cv::Mat image((size.rows + 1) * square_px + 2 * margin_px,
                (size.columns + 1) * square_px + 2 * margin_px, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row <= size.rows; ++row)
    for (int column = row % 2; column <= size.columns; column += 2)
      cv::rectangle(image,
                    cv::Rect(margin_px + column * square_px, margin_px + row * square_px, square_px,
                             square_px),
                    cv::Scalar(20), cv::FILLED);
  const cv::Point2f centre(0.5f * static_cast<float>(image.cols),
                           0.5f * static_cast<float>(image.rows));
  cv::warpAffine(image, image, cv::getRotationMatrix2D(centre, 4.0, 0.95), image.size(),
                 cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::GaussianBlur(image, image, {3, 3}, 0.8);
  return image;
}

BoardSize size_in_photographs(const std::vector<BoardSize>& sizes) {
  const ScratchFolder folder;
  std::vector<std::filesystem::path> images;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    images.push_back(folder.path() / fmt::format("{}.png", i));
    cv::imwrite(images.back().string(), photograph(sizes[i]));
  }
  return find_board_size(images);
}

void expect_size(const BoardSize& size, int columns, int rows) {
  EXPECT_EQ(std::max(size.columns, size.rows), columns);
  EXPECT_EQ(std::min(size.columns, size.rows), rows);
}

TEST(FindBoardSize, SmallBoardsInTheBackgroundDoNotDecide) {
  const BoardSize board{9, 6}, background{4, 3};
  expect_size(
      size_in_photographs({background, background, background, background, board, board, board}), 9,
      6);
}

TEST(FindBoardSize, SmallBoardsAreFound) {
  expect_size(size_in_photographs({{4, 3}, {4, 3}, {4, 3}}), 4, 3);
}

TEST(FindBoardSize, LargeBoardsAreFound) {
  expect_size(size_in_photographs({{14, 10}, {14, 10}, {14, 10}, {14, 10}}), 14, 10);
}

TEST(FindBoardSize, OfTwoImagesIsNotClear) {
  testing::expect_error(
      [] {
        size_in_photographs({{8, 3}, {8, 3}, {4, 3}});
      },
      "seen in only 2 of 3 images; give --columns");
}

TEST(FindBoardSize, CornersOfAFileTellIt) {
  const TemporaryFolder folder;
  put(folder / "c.json",
      R"({"details": {"board": {"target": "chessboard", "columns": 7, "rows": 4}}})");
  const auto size = board_size_of_corners(folder / "c.json");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->columns, 7);
  EXPECT_EQ(size->rows, 4);
  put(folder / "c.json", R"({"details": {"board": {"target": "chessboard", "columns": "x"}}})");
  EXPECT_THROW(board_size_of_corners(folder / "c.json"), Error);
  put(folder / "c.json", R"({"details": {"board": 3}})");
  EXPECT_FALSE(board_size_of_corners(folder / "c.json"));
  put(folder / "c.json", "# filename x y level\n");
  EXPECT_FALSE(board_size_of_corners(folder / "c.json"));
}

/// Images of 12 bits, as machine vision cameras store them in 16.
TEST(DecodeGrey, UsesTheHighestBitsThatAreUsed) {
  const TemporaryFolder folder;
  const auto decoded = [&](std::uint16_t brightest) {
    const cv::Mat image = (cv::Mat_<std::uint16_t>(1, 2) << brightest / 2, brightest);
    cv::imwrite((folder / "a.png").string(), image);
    return decode_grey_pixels(folder / "a.png");
  };
  for (const int brightest : {4095, 65535, 255}) {
    const cv::Mat grey = decoded(static_cast<std::uint16_t>(brightest));
    ASSERT_EQ(grey.type(), CV_8U);
    EXPECT_EQ(grey.at<std::uint8_t>(0), 127) << brightest;
    EXPECT_EQ(grey.at<std::uint8_t>(1), 255) << brightest;
  }
}

TEST(DecodeGrey, RefusesImagesWithoutTheirEnd) {
  const TemporaryFolder folder;
  const cv::Mat image(64, 64, CV_8U, cv::Scalar(90));
  for (const char* name : {"a.jpg", "a.png"}) {
    cv::imwrite((folder / name).string(), image);
    EXPECT_FALSE(decode_grey_pixels(folder / name).empty()) << name;
    const std::string bytes = read_file(folder / name);
    put(folder / name, bytes.substr(0, bytes.size() - 20));
    EXPECT_TRUE(decode_grey_pixels(folder / name).empty()) << name;
  }
}

}  // namespace
}  // namespace touchtrace
