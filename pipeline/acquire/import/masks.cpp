#include "pipeline/acquire/import/masks.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <stdexcept>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/import/images/named_images.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_named_ids = 20;

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

/// Name of a file without its extension and without leading zeros of its whole numbers.
std::string plain_name(const fs::path& file) {
  static const std::regex zeros("(^|[^0-9.])0+(?=[0-9])");
  return std::regex_replace(file.stem().string(), zeros, "$1");
}

/// Masks with the names of images by the images' index. Leading zeros of numbers may differ.
std::map<std::size_t, fs::path> named_masks(const std::map<std::string, fs::path>& by_name,
                                            const std::vector<SourceImage>& images) {
  std::map<std::string, fs::path> by_plain_name;
  for (const auto& [name, file] : by_name) by_plain_name.emplace(plain_name(file), file);
  std::map<std::size_t, fs::path> masks;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const fs::path image = images[i].name;
    if (const auto found = by_name.find(image.stem()); found != by_name.end())
      masks[i] = found->second;
    else if (const auto plain = by_plain_name.find(plain_name(image)); plain != by_plain_name.end())
      masks[i] = plain->second;
  }
  return masks;
}

/// Warns of masks whose name no colour image has.
void warn_of_unused(std::map<std::string, fs::path> by_name,
                    const std::map<std::size_t, fs::path>& masks) {
  const std::size_t num_files = by_name.size();
  for (const auto& [image, file] : masks) by_name.erase(file.stem());
  if (by_name.empty()) return;
  const std::string first = by_name.begin()->second.filename(),
                    last = by_name.rbegin()->second.filename();
  Progress::warn(fmt::format("{} of {} masks are skipped: no colour image has the name of {}",
                             by_name.size(), num_files,
                             first == last ? first : first + ", .. " + last));
}

/// Instances of an image: its values or, with three channels, the palette's indices of its colours.
/// -1: a colour that is not the palette's.
std::set<int> ids_in(const cv::Mat& mask) {
  std::set<int> ids;
  if (mask.channels() == 1) {
    cv::Mat values;
    mask.convertTo(values, CV_32S);
    ids.insert(values.begin<int>(), values.end<int>());
    return ids;
  }
  std::set<std::array<std::uint8_t, 3>> colors;
  for (auto at = mask.begin<cv::Vec3b>(); at != mask.end<cv::Vec3b>(); ++at)
    colors.insert({(*at)[0], (*at)[1], (*at)[2]});
  for (int id = 0; id < 256; ++id) {
    const cv::Vec3b color = palette_color(id);
    if (colors.erase({color[0], color[1], color[2]}) > 0) ids.insert(id);
  }
  if (!colors.empty()) ids.insert(-1);
  return ids;
}

std::string text_of(const std::set<int>& ids) {
  std::vector<std::string> names;
  for (const int id : ids) names.push_back(id < 0 ? "other colours" : std::to_string(id));
  if (names.size() > max_named_ids) names.resize(max_named_ids), names.emplace_back("..");
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Masks of a folder by the index of their colour image.
std::map<std::size_t, fs::path> files_by_image(const fs::path& folder,
                                               const std::vector<SourceImage>& images) {
  auto files = images_in_folder(folder);
  std::map<std::string, fs::path> by_name;
  for (const fs::path& file : files) by_name[file.stem()] = file;
  auto masks = named_masks(by_name, images);
  if (!masks.empty()) {
    warn_of_unused(by_name, masks);
    return masks;
  }
  if (files.size() != images.size())
    throw data_error(fmt::format("{} has {} masks for {} colour images, with other names",
                                 folder.string(), files.size(), images.size()),
                     "give masks the file names of their colour images, or one for each image; "
                     "masks of one body each belong into the folders hand and object");
  files = order_by_name(std::move(files)).files;
  for (std::size_t i = 0; i < files.size(); ++i) masks[i] = files[i];
  return masks;
}

void require_size(const cv::Mat& mask, const cv::Size& size) {
  if (mask.size() != size)
    throw std::runtime_error(fmt::format("{}x{} pixels instead of {}x{}", mask.cols, mask.rows,
                                         size.width, size.height));
}

/// Whether three channels are equal everywhere: numbers, not colours.
bool is_grey(const cv::Mat& mask) {
  if (mask.channels() != 3) return false;
  return std::all_of(mask.begin<cv::Vec3b>(), mask.end<cv::Vec3b>(),
                     [](const cv::Vec3b& p) { return p[0] == p[1] && p[1] == p[2]; });
}

/// 255 where a body is.
cv::Mat read_body(const fs::path& file, const cv::Size& size) {
  const cv::Mat mask = decode_image(
      file, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  if (mask.empty()) throw std::runtime_error("not a readable image");
  require_size(mask, size);
  double most = 0.0;
  cv::minMaxLoc(mask, nullptr, &most);
  return mask > 0.5 * most;
}

}  // namespace

std::map<std::size_t, MaskFile> mask_files(const fs::path& folder,
                                           const std::vector<SourceImage>& images) {
  std::map<std::size_t, MaskFile> masks;
  const fs::path hand = folder / "hand", object = folder / "object";
  const bool has_hand = fs::is_directory(hand), has_object = fs::is_directory(object);
  if (has_hand)
    for (auto& [image, file] : files_by_image(hand, images)) masks[image].hand = file;
  if (has_object)
    for (auto& [image, file] : files_by_image(object, images)) masks[image].object = file;
  if (has_hand || has_object) return masks;
  for (auto& [image, file] : files_by_image(folder, images)) masks[image].instances = file;
  return masks;
}

std::vector<std::uint8_t> InstanceMaskReader::read(const MaskFile& mask, const cv::Size& size) {
  const cv::Mat values =
      mask.instances.empty() ? read_bodies(mask, size) : read_instances(mask.instances, size);
  return {values.begin<std::uint8_t>(), values.end<std::uint8_t>()};
}

cv::Mat InstanceMaskReader::read_bodies(const MaskFile& mask, const cv::Size& size) {
  cv::Mat values(size, CV_8U, cv::Scalar(mask_other));
  found_.insert(0);
  if (!mask.hand.empty()) values.setTo(mask_hand, read_body(mask.hand, size));
  if (!mask.object.empty()) values.setTo(mask_object, read_body(mask.object, size));
  if (cv::countNonZero(values == mask_hand) > 0) found_.insert(ids_.hand);
  if (cv::countNonZero(values == mask_object) > 0) found_.insert(ids_.object);
  return values;
}

cv::Mat InstanceMaskReader::read_instances(const fs::path& file, const cv::Size& size) {
  cv::Mat mask = decode_image(file, cv::IMREAD_UNCHANGED);
  if (mask.empty() || mask.channels() == 2 || mask.channels() > 3 ||
      (mask.channels() == 3 && mask.depth() != CV_8U))
    throw std::runtime_error("not a mask of one channel or of palette colours");
  require_size(mask, size);
  if (is_grey(mask)) cv::extractChannel(mask.clone(), mask, 0);
  found_.merge(ids_in(mask));
  cv::Mat values(size, CV_8U, cv::Scalar(mask_other));
  values.setTo(mask_hand, pixels_of(mask, ids_.hand));
  values.setTo(mask_object, pixels_of(mask, ids_.object));
  return values;
}

void InstanceMaskReader::require_ids() const {
  if (found_.empty()) return;
  if (found_ == std::set{0})
    throw data_error("all pixels of all masks are 0", "give masks that show hand or object");
  const bool has_hand = found_.contains(ids_.hand), has_object = found_.contains(ids_.object);
  const std::string found = text_of(found_);
  if (!has_hand && !has_object)
    throw data_error(fmt::format("no mask has the id {} of the hand or {} of the object; found: {}",
                                 ids_.hand, ids_.object, found),
                     "give --hand-id and --object-id");
  if (!has_hand || !has_object)
    Progress::warn(
        fmt::format("the masks show the {} only: none has the id {} of the {} (--{}-id); found: {}",
                    has_hand ? "hand" : "object", has_hand ? ids_.object : ids_.hand,
                    has_hand ? "object" : "hand", has_hand ? "object" : "hand", found));
}

}  // namespace touchtrace
