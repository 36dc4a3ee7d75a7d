#pragma once

#include "calib/board/chessboard.h"

namespace touchtrace {

/// The dictionaries of markers that are known: "4x4_50", ..., "7x7_1000", "original".
std::vector<std::string> marker_dictionaries();

/// The corners of a ChArUco board that the image shows between its markers, and which they are;
/// nothing if too few are seen to place the board (8, and two in each direction). The board is the
/// one that cv::aruco::CharucoBoard draws (Garrido-Jurado et al., Pattern Recognition 2014); its
/// corners are saddle points of the image, 0.02 to 0.03 px off on boards drawn into 640x480 pixels
/// where those of interpolateCornersCharuco are 0.11 to 0.16 px off. Throws usage_error for an
/// unknown dictionary, one with too few markers for the board, or a marker that is no smaller than
/// a square.
std::pair<std::vector<Eigen::Vector2d>, std::vector<int>> find_marked_corners(
    const GreyImage& image, const Chessboard& board);

}  // namespace touchtrace
