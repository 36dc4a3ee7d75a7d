#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>

#include "calib/board/board_detector.h"
#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Depth [m]; 0: no measurement.
std::vector<float> read_depth(const fs::path& path, const GreyImage& color) {
  const cv::Mat counts = decode_image(path, cv::IMREAD_UNCHANGED);
  if (counts.type() != CV_16UC1 || counts.cols != color.width || counts.rows != color.height)
    throw data_error(fmt::format("{} is not a 16-bit depth image of {}x{} pixels", path.string(),
                                 color.width, color.height),
                     "give a folder in the format of the TUM RGB-D benchmark");
  cv::Mat metres;
  counts.convertTo(metres, CV_32F, 1.0 / tum_counts_per_m);
  return {metres.begin<float>(), metres.end<float>()};
}

}  // namespace

BoardObservations board_views_from_tum(const fs::path& folder, const CalibrationTarget& board) {
  const auto pairs = select_tum_pairs(read_tum_pairs(folder));
  BoardDetector detector(board);
  GreyImage first;
  Progress progress("detecting the board", pairs.size());
  for (const TumPair& pair : pairs) {
    const GreyImage image = read_grey(pair.color);
    if (first.width == 0) first = image;
    require_same_size(first, image, pair.color);
    const double start_s = pairs.front().color_time_s;
    detector.add({.name = pair.color.filename().string(),
                  .depth_m = read_depth(pair.depth, image),
                  .color_time_s = pair.color_time_s - start_s,
                  .depth_time_s = pair.depth_time_s - start_s},
                 image);
    progress.advance();
  }
  return std::move(detector).finish();
}

}  // namespace touchtrace
