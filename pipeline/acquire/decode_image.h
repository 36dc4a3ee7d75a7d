#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace touchtrace {

/// Reads an image file; `flags` as for cv::imread. Empty if it is not a readable image. Throws
/// data_error if the file cannot be read.
cv::Mat decode_image(const std::filesystem::path& path, int flags);

/// Reads an image file as 8-bit grey, without its EXIF orientation. Of 16-bit images the highest 8
/// bits that are used: else 12-bit images would have 16 levels. Empty if it is not a
/// readable image, or its end is missing. Throws data_error if the file cannot be read.
cv::Mat decode_grey_pixels(const std::filesystem::path& path);

}  // namespace touchtrace
