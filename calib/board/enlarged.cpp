#include "calib/board/enlarged.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace touchtrace {
namespace {

constexpr double wanted_size_px = 1280.0;
constexpr int max_enlargement = 4;

}  // namespace

EnlargedImage::EnlargedImage(const GreyImage& image, int times) : scale(times) {
  const cv::Mat original(image.height, image.width, CV_8U,
                         const_cast<std::uint8_t*>(image.pixels.data()));
  cv::resize(original, pixels, cv::Size(), scale, scale, cv::INTER_CUBIC);
}

int usual_enlargement(const GreyImage& image) {
  const double size_px = std::max(image.width, image.height);
  return std::clamp(static_cast<int>(std::lround(wanted_size_px / size_px)), 1, max_enlargement);
}

}  // namespace touchtrace
