#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/files.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/tum_folder.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

constexpr int tum_width = 320, tum_height = 240;
constexpr double tum_depth_m = 0.6;
const CalibrationTarget tum_board{5, 4, 0.03};

/// Board parallel to the image plane, first corner at (x, y).
cv::Mat drawn_board(int x, int y) {
  constexpr int square_px = 24;
  cv::Mat image(tum_height, tum_width, CV_8UC3, cv::Scalar::all(230));
  for (int row = -1; row < tum_board.rows; ++row)
    for (int column = -1; column < tum_board.columns; ++column)
      if ((row + column) % 2 == 0)
        cv::rectangle(image,
                      cv::Rect(x + column * square_px, y + row * square_px, square_px, square_px),
                      cv::Scalar::all(20), cv::FILLED);
  cv::GaussianBlur(image, image, {3, 3}, 0.7);
  return image;
}

void write_tum(const fs::path& folder) {
  fs::create_directories(folder / "rgb"), fs::create_directories(folder / "depth");
  std::string rgb = "# color images\n# timestamp filename\n", depth = "# depth maps\n\n";
  for (int i = 0; i < 4; ++i) {
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite((folder / "rgb" / name).string(), drawn_board(80 + 10 * i, 70 + 5 * i));
    cv::imwrite((folder / "depth" / name).string(),
                cv::Mat(tum_height, tum_width, CV_16UC1, cv::Scalar(5000.0 * tum_depth_m)));
    rgb += "1305031102." + std::to_string(100 + 33 * i) + " rgb/" + name + "\n";
    depth += "1305031102." + std::to_string(104 + 33 * i) + " depth/" + name + "\n";
  }
  write_file(folder / "rgb.txt", rgb, true), write_file(folder / "depth.txt", depth, true);
}

TEST(TumViews, ReadsCornersDepthAndTimes) {
  const TemporaryFolder folder;
  write_tum(folder / "tum");
  ASSERT_TRUE(is_tum_folder(folder / "tum"));
  const BoardObservations o = board_views_from_tum(folder / "tum", tum_board);
  ASSERT_EQ(o.views.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const BoardView& view = o.views[i];
    EXPECT_EQ(view.corners_px.size(), 20u);
    EXPECT_FLOAT_EQ(view.depth_m[tum_width * 120 + 160], float(tum_depth_m));
    EXPECT_NEAR(view.color_time_s, 0.033 * double(i), 1e-6);
    EXPECT_NEAR(view.depth_time_s - view.color_time_s, 0.004, 1e-6);
  }
  EXPECT_EQ(image_files({(folder / "tum").string()}).size(), 10u);
}

TEST(TumViews, PairsEachDepthImageOnceWithinTwentyMilliseconds) {
  const TemporaryFolder folder;
  write_tum(folder / "tum");
  write_file(folder / "tum" / "depth.txt",
             "1305031102.101 depth/0.png\n1305031102.190 depth/1.png\n", true);
  const auto pairs = read_tum_pairs(folder / "tum");
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].depth.filename(), "0.png");
  EXPECT_EQ(pairs[1].color.filename(), "3.png");  // at .199; .166 is 24 ms away
}

TEST(TumViews, RejectsInvalidListsAndImages) {
  const TemporaryFolder folder;
  const auto expect_rejected = [&](const char* list, const std::string& text) {
    write_tum(folder / "tum");
    write_file(folder / "tum" / list, text, true);
    testing::expect_error([&] { board_views_from_tum(folder / "tum", tum_board); }, "");
  };
  expect_rejected("rgb.txt", "");
  expect_rejected("rgb.txt", "1305031102.1\n");
  expect_rejected("rgb.txt", "abc rgb/0.png\n");
  expect_rejected("rgb.txt", "nan rgb/0.png\n");
  expect_rejected("rgb.txt", "1305031102.1 ../secret.png\n");
  expect_rejected("rgb.txt", "1305031102.1 /etc/passwd\n");
  expect_rejected("rgb.txt", "1305031102.1 rgb/9.png\n");
  expect_rejected("depth.txt", "1305031102.1 rgb/0.png\n");  // 8 bits, 3 channels
  expect_rejected("depth.txt", "99.0 depth/0.png\n");
}

}  // namespace
}  // namespace touchtrace
