#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "calib/board/chessboard.h"

namespace touchtrace {

/// An image enlarged to about 1280 pixels, where corners are found best. Pixel centres are integers
/// in both.
struct EnlargedImage {
  cv::Mat pixels;
  int scale;

  EnlargedImage(const GreyImage& image, int times);
  Eigen::Vector2d in_original(const cv::Point2f& p) const {
    return {(p.x + 0.5) / scale - 0.5, (p.y + 0.5) / scale - 0.5};
  }
};

/// How many times that is.
int usual_enlargement(const GreyImage& image);

}  // namespace touchtrace
