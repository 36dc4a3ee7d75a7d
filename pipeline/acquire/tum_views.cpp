#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr float counts_per_m = 5000.0f;

/// Depth [m]; 0: no measurement.
std::vector<float> read_depth(const fs::path& path, const GreyImage& color) {
  const cv::Mat counts = decode_image(path, cv::IMREAD_UNCHANGED);
  if (counts.type() != CV_16UC1 || counts.cols != color.width || counts.rows != color.height)
    throw data_error(fmt::format("{} is not a 16-bit depth image of {}x{} pixels", path.string(),
                                 color.width, color.height),
                     "give a folder in the format of the TUM RGB-D benchmark");
  cv::Mat metres;
  counts.convertTo(metres, CV_32F, 1.0 / counts_per_m);
  return {metres.begin<float>(), metres.end<float>()};
}

}  // namespace

BoardObservations board_views_from_tum(const fs::path& folder, const Chessboard& board) {
  const auto pairs = select_tum_pairs(read_tum_pairs(folder));
  BoardObservations observations;
  observations.board = board;
  Progress progress("detecting the board", pairs.size());
  for (const TumPair& pair : pairs) {
    const GreyImage image = read_grey(pair.color);
    if (observations.width == 0)
      observations.width = image.width, observations.height = image.height;
    require_same_size(observations, image, pair.color);
    const std::size_t before = observations.views.size();
    add_view(observations, pair.color.filename().string(), image, read_depth(pair.depth, image));
    if (observations.views.size() > before) {
      observations.views.back().color_time_s = pair.color_time_s - pairs.front().color_time_s;
      observations.views.back().depth_time_s = pair.depth_time_s - pairs.front().color_time_s;
    }
    progress.advance();
  }
  return observations;
}

}  // namespace touchtrace
