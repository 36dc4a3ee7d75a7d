#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "calib/board/grey_image.h"

namespace touchtrace {

/// Image upscaled by an integer factor (bicubic). Pixel centres are at integers before and after.
struct UpscaledImage {
  cv::Mat pixels;
  int scale;

  UpscaledImage(const GreyImage& image, int factor);
  /// Maps upscaled to original pixel coordinates.
  Eigen::Vector2d to_original(const cv::Point2f& p) const {
    return {(p.x + 0.5) / scale - 0.5, (p.y + 0.5) / scale - 0.5};
  }
};

/// Factor, 1 to 4, that makes the larger side about 1280 pixels: corner detection is most accurate
/// there.
int default_upscale_factor(const GreyImage& image);

}  // namespace touchtrace
