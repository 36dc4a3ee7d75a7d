#include "pipeline/label/preview/contact_sheet.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "engine/base/parallel.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t num_spread = 12, num_flagged = 4, max_bytes = 400'000;
constexpr int num_columns = 4, tile_px = 400;

/// Frames [first, first + count) with a flag.
struct Stretch {
  std::size_t first, count;
};

/// The longest flagged stretches.
std::vector<Stretch> flagged_stretches(const LabelOverlay& overlay) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < overlay.num_frames(); ++i) {
    if (!overlay.is_flagged(i)) continue;
    if (stretches.empty() || stretches.back().first + stretches.back().count != i)
      stretches.push_back({i, 0});
    ++stretches.back().count;
  }
  std::ranges::stable_sort(stretches, std::ranges::greater(), &Stretch::count);
  stretches.resize(std::min(stretches.size(), num_flagged));
  return stretches;
}

std::set<std::size_t> chosen_frames(const LabelOverlay& overlay) {
  std::vector<std::size_t> labelled;
  for (std::size_t i = 0; i < overlay.num_frames(); ++i)
    if (overlay.has_label(i)) labelled.push_back(i);
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; !labelled.empty() && i < num_spread; ++i)
    chosen.insert(labelled[i * (labelled.size() - 1) / (num_spread - 1)]);
  for (const auto& stretch : flagged_stretches(overlay)) chosen.insert(stretch.first);
  return chosen;
}

cv::Mat tiled(const std::vector<cv::Mat>& tiles) {
  const int rows = (static_cast<int>(tiles.size()) + num_columns - 1) / num_columns;
  const cv::Size tile = tiles.front().size();
  cv::Mat sheet(rows * tile.height, num_columns * tile.width, CV_8UC3, cv::Scalar::all(20));
  for (int i = 0; i < static_cast<int>(tiles.size()); ++i)
    tiles[static_cast<std::size_t>(i)].copyTo(
        sheet(cv::Rect({i % num_columns * tile.width, i / num_columns * tile.height}, tile)));
  return sheet;
}

}  // namespace

std::vector<std::uint8_t> contact_sheet_jpeg(const LabelOverlay& overlay, const FrameSource& frames,
                                             int num_threads) {
  const auto chosen = chosen_frames(overlay);
  const std::vector<std::size_t> shown(chosen.begin(), chosen.end());
  if (shown.empty()) return {};
  std::vector<cv::Mat> tiles(shown.size());
  parallel_for(shown.size(), num_threads, [&](std::size_t i) {
    tiles[i] = overlay.draw(shown[i], frames.camera_frame(shown[i]), tile_px);
  });
  const cv::Mat sheet = tiled(tiles);
  std::vector<std::uint8_t> jpeg;
  for (int quality = 90; quality > 0 && (jpeg.empty() || jpeg.size() > max_bytes); quality -= 10)
    cv::imencode(".jpg", sheet, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
  return jpeg;
}

}  // namespace touchtrace::label
