#pragma once

#include "calib/board/board_view.h"

namespace touchtrace {

/// Returns the visible corners of a ChArUco board (Garrido-Jurado et al., Pattern Recognition
/// 2014) and their board indices. Both are empty below 8 corners, or if these do not span two rows
/// and two columns. Board layout: cv::aruco::CharucoBoard, with a black square in the upper left
/// corner, or a white one (cv::aruco::CharucoBoard::setLegacyPattern); the markers tell which.
///
/// A corner is used if both markers that touch it are decoded, and refined as a saddle point. On
/// boards drawn into 640x480 pixels their error is 0.02 to
/// 0.03 px; that of interpolateCornersCharuco is 0.11 to 0.16 px.
///
/// Throws usage_error for an unknown dictionary, one with fewer markers than the board needs, or a
/// marker that is not smaller than a square.
TargetCorners find_charuco_corners(const GreyImage& image, const CalibrationTarget& board);

}  // namespace touchtrace
