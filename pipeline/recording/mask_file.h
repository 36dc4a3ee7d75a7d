#pragma once

#include <array>
#include <map>

#include "pipeline/recording/image_file.h"

namespace touchtrace {

/// Writes the group /masks, where the instances of hand and object are MaskValue.
class MaskWriter {
 public:
  MaskWriter(h5::Saver group, const CameraInfo& camera);

  /// `mask`: MaskValue of each pixel of the colour image with index `color_image`.
  void append(std::size_t color_image, const std::vector<std::uint8_t>& mask);
  void finish();

 private:
  h5::Saver group_;
  ImageWriter images_;
  std::vector<std::int64_t> color_image_;
};

/// Reads the group /masks, if there is one.
class MaskReader {
 public:
  /// Records faults in `root.faults()`. `color_images`: number of colour images.
  MaskReader(const h5::Loader& root, const CameraInfo& camera, std::size_t color_images);

  /// Colour images that have a mask, in increasing order.
  std::vector<std::size_t> color_images() const;
  /// MaskValue of each pixel; empty if the colour image has no mask. `file` is named in errors.
  std::vector<std::uint8_t> read(std::size_t color_image, const std::string& file) const;

 private:
  void read_frames(const h5::Loader& group, std::size_t color_images);
  void read_instances(const h5::Loader& group, const std::string& name, MaskValue value);

  std::optional<ImageReader> images_;
  std::map<std::size_t, std::size_t> mask_of_color_;
  std::array<std::uint8_t, 256> value_of_instance_{};
};

}  // namespace touchtrace
