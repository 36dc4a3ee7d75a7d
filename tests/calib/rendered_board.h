#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "calib/board/board_detector.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/random.h"

namespace touchtrace::testing {

inline constexpr int rendered_width = 640, rendered_height = 480, print_px_per_m = 4000;
inline const Eigen::Matrix3d rendered_camera =
    (Eigen::Matrix3d() << 600.0, 0.0, 322.0, 0.0, 602.0, 238.0, 0.0, 0.0, 1.0).finished();

/// Drawing of a board, print_px_per_m.
struct BoardPrint {
  cv::Mat pixels;
  Eigen::Vector2d origin_m;  ///< of the board frame, from the upper left corner of the drawing
};

/// camera_from_board with the board's centre at `centre_m`.
inline Eigen::Isometry3d board_pose(const CalibrationTarget& board,
                                    const Eigen::Vector3d& angle_axis,
                                    const Eigen::Vector3d& centre_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_axis.norm(), angle_axis.normalized()).toRotationMatrix();
  pose.translation() = centre_m - 0.5 * pose.linear() * board.corner_m(board.num_corners() - 1);
  return pose;
}

/// Image of the board before grey, with antialiasing and noise of 1 grey level.
inline GreyImage render(const BoardPrint& print, const Eigen::Isometry3d& camera_from_board) {
  constexpr int finer = 4;
  Eigen::Matrix3d plane, board_from_print, finer_from_image = Eigen::Matrix3d::Identity();
  plane << camera_from_board.linear().leftCols<2>(), camera_from_board.translation();
  board_from_print = Eigen::Vector3d(1.0 / print_px_per_m, 1.0 / print_px_per_m, 1.0).asDiagonal();
  board_from_print.col(2).head<2>() =
      Eigen::Vector2d::Constant(0.5 / print_px_per_m) - print.origin_m;
  finer_from_image.topLeftCorner<2, 2>() *= finer;
  finer_from_image.col(2).head<2>().setConstant(0.5 * (finer - 1));
  const Eigen::Matrix3d h = finer_from_image * rendered_camera * plane * board_from_print;
  const cv::Matx33d finer_from_print(h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0),
                                     h(2, 1), h(2, 2));
  cv::Mat fine, image;
  cv::warpPerspective(print.pixels, fine, finer_from_print,
                      {finer * rendered_width, finer * rendered_height}, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 170);
  cv::resize(fine, image, {rendered_width, rendered_height}, 0, 0, cv::INTER_AREA);
  RandomStream random(1, "photograph");
  GreyImage grey{rendered_width, rendered_height, {}};
  for (int i = 0; i < rendered_width * rendered_height; ++i)
    grey.pixels.push_back(cv::saturate_cast<std::uint8_t>(image.data[i] + random.normal()));
  return grey;
}

/// RMS distance [px] of detected corners from the truth.
inline double corner_rms_px(const CalibrationTarget& board,
                            const Eigen::Isometry3d& camera_from_board,
                            const std::vector<Eigen::Vector2d>& corners_px,
                            const std::vector<int>& ids) {
  double squares = 0.0;
  for (std::size_t i = 0; i < corners_px.size(); ++i) {
    const Eigen::Vector3d corner_m = camera_from_board * board.corner_m(ids[i]);
    squares += (corners_px[i] - (rendered_camera * corner_m).hnormalized()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(corners_px.size()));
}

/// Expects `rendered_camera`, to 0.5 px.
inline void expect_rendered_camera(const Camera& camera) {
  EXPECT_NEAR(camera.fx, rendered_camera(0, 0), 0.5);
  EXPECT_NEAR(camera.fy, rendered_camera(1, 1), 0.5);
  EXPECT_NEAR(camera.cx, rendered_camera(0, 2), 0.5);
  EXPECT_NEAR(camera.cy, rendered_camera(1, 2), 0.5);
}

/// Tilts and places of view `i` of a calibration: to the left, in the middle and to the right by
/// `side_m`, in turn.
inline Eigen::Isometry3d calibration_pose(const CalibrationTarget& board, int i, double side_m,
                                          double distance_m) {
  const double sides_m[] = {-side_m, 0.0, side_m};
  const Eigen::Vector3d turn(0.5 * ((i % 3) - 1) + 0.1, 0.5 * ((i / 3) % 2 ? 1 : -1), 0.1 * i);
  return board_pose(board, turn, {sides_m[i % 3], sides_m[(i / 4) % 3] * 0.7, distance_m});
}

/// Detects a board in twelve views from `distance_m` on, each farther by `step_m`.
inline BoardObservations observe(const BoardPrint& print, const CalibrationTarget& board,
                                 double side_m, double distance_m, double step_m) {
  BoardDetector detector(board);
  for (int i = 0; i < 12; ++i)
    detector.add({.name = "view " + std::to_string(i)},
                 render(print, calibration_pose(board, i, side_m, distance_m + step_m * i)));
  return std::move(detector).finish();
}

inline void expect_calibration(const BoardObservations& observed, double max_rms_px) {
  ASSERT_GE(observed.views.size(), 10u);
  const RgbdCalibration found = calibrate(observed);
  EXPECT_LT(found.rms_px, max_rms_px);
  expect_rendered_camera(found.color);
}

inline bool shows_parts(const BoardObservations& observed) {
  return std::ranges::any_of(observed.views, [&](const BoardView& view) {
    return int(view.corners_px.size()) < observed.board.num_corners();
  });
}

/// A view, and how many corners it shows.
struct Placement {
  const char* name;
  Eigen::Vector3d angle_axis, centre_m;
  std::size_t min_corners, max_corners;

  friend void PrintTo(const Placement& value, std::ostream* stream) { *stream << value.name; }
};

inline void expect_accurate_corners(const BoardPrint& print, const CalibrationTarget& board,
                                    const Placement& placed, double max_rms_px) {
  const auto pose = board_pose(board, placed.angle_axis, placed.centre_m);
  const auto [corners, ids] = board.kind->find_corners(render(print, pose), board);
  EXPECT_GE(corners.size(), placed.min_corners);
  EXPECT_LE(corners.size(), placed.max_corners);
  const double error_px = corner_rms_px(board, pose, corners, ids);
  ::testing::Test::RecordProperty("error_px", std::to_string(error_px));
  EXPECT_LT(error_px, max_rms_px);
}

inline const GreyImage plain_image{64, 48, std::vector<std::uint8_t>(64 * 48, 128)};

inline bool finds_nothing(const GreyImage& image, const CalibrationTarget& board) {
  return board.kind->find_corners(image, board).corners_px.empty();
}

/// Expects that `asked` is not found, and that the message about what is seen contains `seen`.
inline void expect_other(const GreyImage& image, const CalibrationTarget& asked,
                         const std::string& seen) {
  EXPECT_TRUE(finds_nothing(image, asked));
  const auto other = asked.kind->find_other(image, asked);
  ASSERT_TRUE(other);
  EXPECT_NE(other->seen.find(seen), std::string::npos) << other->seen;
}

/// Expects that a board of kind `kind` is named where any other kind was asked for.
inline void expect_recognized(const GreyImage& image, const TargetKind& kind,
                              const std::string& seen) {
  for (const TargetKind* asked : target_kinds()) {
    if (asked == &kind) continue;
    const auto other = recognize_target(image, *asked);
    ASSERT_TRUE(other) << asked->name;
    EXPECT_EQ(other->seen, seen) << asked->name;
  }
}

}  // namespace touchtrace::testing
