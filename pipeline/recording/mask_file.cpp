#include "pipeline/recording/mask_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchtrace {
namespace {

constexpr h5::DatasetInfo color_frame_info{"1", "index of the colour image"};

}  // namespace

MaskWriter::MaskWriter(h5::Saver group, const CameraInfo& camera)
    : group_(std::move(group)), images_(group_, "image", ImageKind::mask, camera) {}

void MaskWriter::append(std::size_t color_image, const std::vector<std::uint8_t>& mask) {
  images_.append(mask);
  color_image_.push_back(static_cast<std::int64_t>(color_image));
}

void MaskWriter::finish() {
  group_.attribute("hand", int{mask_hand});
  group_.attribute("object", int{mask_object});
  images_.finish(group_.axis("color_frame", color_image_, color_frame_info));
}

MaskReader::MaskReader(const h5::Loader& root, const CameraInfo& camera, std::size_t color_images) {
  const h5::Loader group = root.optional_group("masks");
  if (!group.has("image")) return;
  images_.emplace(group, "image", ImageKind::mask, camera);
  read_frames(group, color_images);
  read_instances(group, "hand", mask_hand);
  read_instances(group, "object", mask_object);
}

void MaskReader::read_frames(const h5::Loader& group, std::size_t color_images) {
  std::vector<std::int64_t> frames(images_->frames());
  std::iota(frames.begin(), frames.end(), 0);
  group.optional_array("color_frame", frames, {{"image", images_->frames()}}, color_frame_info);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto color = static_cast<std::size_t>(frames[i]);
    group.faults().require(
        frames[i] >= 0 && color < color_images, group.path("color_frame"),
        fmt::format("expected indices of the {} colour images, found {}", color_images, frames[i]));
    group.faults().require(
        mask_of_color_.emplace(color, i).second, group.path("color_frame"),
        fmt::format("expected one mask per colour image, found two of image {}", frames[i]));
  }
}

void MaskReader::read_instances(const h5::Loader& group, const std::string& name, MaskValue value) {
  std::vector<double> ids{static_cast<double>(value)};
  group.optional_attribute(name, ids);
  for (double id : ids) {
    const bool valid = id >= 1.0 && id <= 255.0 && id == std::trunc(id);
    group.faults().require(valid, attribute_path(group.path(), name),
                           fmt::format("expected instance ids from 1 to 255, found {}", id));
    if (valid) value_of_instance_[static_cast<std::size_t>(id)] = value;
  }
}

std::vector<std::size_t> MaskReader::color_images() const {
  std::vector<std::size_t> images;
  for (const auto& [color, mask] : mask_of_color_) images.push_back(color);
  return images;
}

std::vector<std::uint8_t> MaskReader::read(std::size_t color_image, const std::string& file) const {
  const auto found = mask_of_color_.find(color_image);
  if (found == mask_of_color_.end()) return {};
  auto mask = images_->read<std::uint8_t>(found->second, file);
  for (auto& pixel : mask) pixel = value_of_instance_[pixel];
  return mask;
}

}  // namespace touchtrace
