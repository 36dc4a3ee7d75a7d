#pragma once

#include <opencv2/core.hpp>

#include "calib/board/grey_image.h"

namespace touchtrace {

/// Copies a matrix of bytes.
inline GreyImage grey_image(const cv::Mat& matrix) {
  const cv::Mat continuous = matrix.isContinuous() ? matrix : matrix.clone();
  return {matrix.cols, matrix.rows, {continuous.datastart, continuous.dataend}};
}

/// The pixels of an image, which are not copied. Only for reading.
inline cv::Mat as_matrix(const GreyImage& image) {
  return {image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())};
}

}  // namespace touchtrace
