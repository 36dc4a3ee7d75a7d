#include "pipeline/acquire/board_size.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <ranges>

#include "calib/board/image_matrix.h"
#include "calib/board/reduced_image.h"
#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/decode_image.h"

namespace touchtrace {
namespace {

constexpr int num_probed_images = 3;
/// Corners by which a size leads the others: three images of 9x6. Small lattices, of a board in the
/// background or of a part of the board, need more images.
constexpr int clear_lead = 150;

/// Number of images that show a rectangle of corners of each size.
using SizeCounts = std::map<BoardSize, int>;

int num_corners(const SizeCounts::value_type& entry) {
  return entry.first.columns * entry.first.rows * entry.second;
}

/// Whether `min_views` images show the size with most corners, and it leads the others.
bool is_clear(const SizeCounts& images_of) {
  int most = 0, second = 0, views = 0;
  for (const auto& entry : images_of) {
    second = std::max(second, std::min(most, num_corners(entry)));
    if (num_corners(entry) > most) most = num_corners(entry), views = entry.second;
  }
  return views >= min_views && most - second >= clear_lead;
}

/// nullopt if the file is not an image.
std::optional<GreyImage> decode_grey(const std::filesystem::path& path) {
  const cv::Mat pixels = decode_grey_pixels(path);
  if (pixels.empty()) return {};
  return grey_image(pixels);
}

/// Error that says what the first images show instead.
Error no_chessboard(const std::vector<std::filesystem::path>& images) {
  if (std::ranges::none_of(images, [](const auto& path) { return decode_grey(path).has_value(); }))
    return data_error(fmt::format("none of {} files is an image that can be read, such as {}",
                                  images.size(), images.front().string()),
                      "convert videos, HEIC and raw files to JPEG or PNG");
  for (const auto& path : images | std::views::take(num_probed_images))
    if (const auto image = decode_grey(path))
      if (const auto other = recognize_target(*image, chessboard_kind))
        return data_error(fmt::format("{} shows no chessboard but {}", path.string(), other->seen),
                          other->hint);
  return data_error("no image shows a chessboard",
                    "give --columns and --rows, which count inner corners, or another --target");
}

}  // namespace

BoardSize find_board_size(const std::vector<std::filesystem::path>& images) {
  SizeCounts images_of;
  Progress progress("looking for the size of the board", images.size());
  for (const auto& path : images) {
    progress.advance();
    const auto image = decode_grey(path);
    if (const auto size = image ? find_board_size(*image) : std::nullopt) ++images_of[*size];
    if (is_clear(images_of)) break;
  }
  if (images_of.empty()) throw no_chessboard(images);
  const auto& [size, shown_in] = *std::ranges::max_element(images_of, {}, num_corners);
  if (shown_in < min_views)
    throw data_error(fmt::format("the size of the chessboard is not clear: {} by {} inner corners "
                                 "are seen in only {} of {} images",
                                 size.columns, size.rows, shown_in, images.size()),
                     "give --columns and --rows, which count inner corners");
  return size;
}

void report_markers(const std::vector<std::filesystem::path>& images) {
  for (const auto& path : images | std::views::take(num_probed_images)) {
    const auto image = decode_grey(path);
    const auto board = image ? charuco_kind.recognize(ReducedImage(*image).image) : std::nullopt;
    if (!board) continue;
    Progress::report(fmt::format("{} shows {}; {}: views of a part of it can then be used",
                                 path.string(), board->seen, board->hint));
    return;
  }
}

void OtherTargetCheck::add(const GreyImage& image, BoardFound found,
                           const std::filesystem::path& path) {
  ++(found == BoardFound::nothing ? missed_ : found_);
  if (found != BoardFound::whole && !other_ && ++probed_ <= num_probed_images) probe(image, path);
  if (missed_ > num_probed_images + 4 * found_) require_no_other();
}

void OtherTargetCheck::probe(const GreyImage& image, const std::filesystem::path& path) {
  if (asked_.kind->find_other) other_ = asked_.kind->find_other(image, asked_);
  if (other_ || !missed_image_) image_ = path.string();
  if (!other_ && !missed_image_) missed_image_ = image;
}

void OtherTargetCheck::finish(std::size_t views) {
  if (views < static_cast<std::size_t>(min_views)) require_no_other();
}

void OtherTargetCheck::require_no_other() {
  if (!other_ && missed_image_ && !is_recognized_)
    other_ = recognize_target(*missed_image_, *asked_.kind);
  is_recognized_ = true;
  if (other_) throw data_error(fmt::format("{} shows {}", image_, other_->seen), other_->hint);
}

}  // namespace touchtrace
