#include "pipeline/acquire/decode_image.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

#include "engine/base/files.h"

namespace touchtrace {
namespace {

/// Whether the end of a JPEG or PNG file is missing, which OpenCV fills with grey.
bool is_cut_off(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return bytes.rfind("IEND") == std::string_view::npos;
  if (!bytes.starts_with("\xFF\xD8")) return false;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  std::size_t at = 2;  // of a segment; the image, behind the last one, ends with FF D9
  while (at + 4 <= bytes.size() && byte(at) == 0xFF && byte(at + 1) != 0xDA)
    at += 2u + 256u * byte(at + 2) + byte(at + 3);
  return bytes.find("\xFF\xD9", at) == std::string_view::npos;
}

/// The highest 8 bits that are used.
cv::Mat high_bits(const cv::Mat& pixels) {
  double brightest = 0.0;
  cv::minMaxLoc(pixels, nullptr, &brightest);
  int unused = 0;
  while (brightest >= std::ldexp(256.0, unused)) ++unused;
  cv::Mat result(pixels.size(), CV_8U);
  std::transform(pixels.begin<std::uint16_t>(), pixels.end<std::uint16_t>(),
                 result.begin<std::uint8_t>(),
                 [&](std::uint16_t value) { return static_cast<std::uint8_t>(value >> unused); });
  return result;
}

cv::Mat decode(std::string& bytes, int flags) {
  if (bytes.empty() || bytes.size() > INT_MAX) return {};
  try {
    return cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace

cv::Mat decode_image(const std::filesystem::path& path, int flags) {
  std::string bytes = read_file(path);
  return decode(bytes, flags);
}

cv::Mat decode_grey_pixels(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  if (is_cut_off(bytes)) return {};
  constexpr int flags = cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
  const cv::Mat pixels = decode(bytes, flags | cv::IMREAD_ANYDEPTH);
  if (pixels.depth() == CV_16U) return high_bits(pixels);
  return pixels.depth() == CV_8U ? pixels : decode(bytes, flags);
}

}  // namespace touchtrace
