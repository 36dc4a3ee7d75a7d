#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace touchtrace {

/// Reads an image file; `flags` as for cv::imread. Empty if it is not a readable image. Throws
/// data_error if the file cannot be read.
cv::Mat decode_image(const std::filesystem::path& path, int flags);

}  // namespace touchtrace
