#include "calib/board/upscaled_image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/board/image_matrix.h"

namespace touchtrace {
namespace {

constexpr double target_size_px = 1280.0;
constexpr int max_upscale_factor = 4;

}  // namespace

UpscaledImage::UpscaledImage(const GreyImage& image, int factor) : scale(factor) {
  cv::resize(as_matrix(image), pixels, cv::Size(), scale, scale, cv::INTER_CUBIC);
}

int default_upscale_factor(const GreyImage& image) {
  const double size_px = std::max(image.width, image.height);
  return std::clamp(static_cast<int>(std::lround(target_size_px / size_px)), 1, max_upscale_factor);
}

}  // namespace touchtrace
