#include "pipeline/acquire/import/masks.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "engine/base/error.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/import/image_times.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Colour of an instance, blue first: each of its bits, from the lowest, is the next lower bit of
/// red, green and blue in turn.
cv::Vec3b palette_color(int id) {
  cv::Vec3b color(0, 0, 0);
  for (int bit = 0; bit < 8; ++bit)
    if (id >> bit & 1) color[2 - bit % 3] |= static_cast<std::uint8_t>(0x80 >> bit / 3);
  return color;
}

/// 255 where the pixel belongs to the instance.
cv::Mat pixels_of(const cv::Mat& mask, int id) {
  cv::Mat pixels;
  if (mask.channels() == 1)
    cv::compare(mask, cv::Scalar(id), pixels, cv::CMP_EQ);
  else
    cv::inRange(mask, palette_color(id), palette_color(id), pixels);
  return pixels;
}

}  // namespace

std::map<std::size_t, fs::path> mask_files(const fs::path& folder,
                                           const std::vector<SourceImage>& images) {
  auto files = images_in_folder(folder);
  std::map<std::string, fs::path> by_name;
  for (const fs::path& file : files) by_name[file.stem()] = file;
  std::map<std::size_t, fs::path> masks;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (const auto found = by_name.find(fs::path(images[i].name).stem()); found != by_name.end())
      masks[i] = found->second;
  if (!masks.empty()) return masks;
  if (files.size() != images.size())
    throw data_error(fmt::format("{} has {} masks for {} colour images, with other names",
                                 folder.string(), files.size(), images.size()),
                     "give masks the file names of their colour images, or one for each image");
  sort_by_number(files);
  for (std::size_t i = 0; i < files.size(); ++i) masks[i] = files[i];
  return masks;
}

std::vector<std::uint8_t> read_mask(const fs::path& file, const MaskIds& ids,
                                    const cv::Size& size) {
  const cv::Mat mask = decode_image(file, cv::IMREAD_UNCHANGED);
  if (mask.empty() || mask.channels() == 2 || mask.channels() > 3)
    throw std::runtime_error("not a mask of one channel or of palette colours");
  if (mask.size() != size)
    throw std::runtime_error(fmt::format("{}x{} pixels instead of {}x{}", mask.cols, mask.rows,
                                         size.width, size.height));
  cv::Mat values(size, CV_8U, cv::Scalar(mask_other));
  values.setTo(mask_hand, pixels_of(mask, ids.hand));
  values.setTo(mask_object, pixels_of(mask, ids.object));
  return {values.begin<std::uint8_t>(), values.end<std::uint8_t>()};
}

}  // namespace touchtrace
