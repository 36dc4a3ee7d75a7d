#include "pipeline/acquire/decode_image.h"

#include <climits>
#include <opencv2/imgcodecs.hpp>

#include "engine/base/files.h"

namespace touchtrace {

cv::Mat decode_image(const std::filesystem::path& path, int flags) {
  std::string bytes = read_file(path);
  if (bytes.empty() || bytes.size() > INT_MAX) return {};
  try {
    return cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace touchtrace
