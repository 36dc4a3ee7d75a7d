#pragma once

#include <optional>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

enum class ImageKind { color, depth, mask };

/// Shape of an image: height, width and, for colour, 3.
std::vector<hsize_t> image_shape(ImageKind kind, const CameraInfo& camera);

/// Writes the images of one dataset, one per chunk. The dataset is created with the first image.
class ImageWriter {
 public:
  /// `group` must outlive the writer.
  ImageWriter(h5::Saver& group, std::string name, ImageKind kind, const CameraInfo& camera);

  /// Throws failure if the size of the image is not that of the camera.
  template <class T>
  void append(const std::vector<T>& image) {
    append_bytes(h5::bytes_of(image), sizeof(T));
  }
  std::size_t frames() const { return frames_; }
  /// Attaches dimension scales and closes. `axis_prefix`: of the axes y and x.
  void finish(const h5::Axis& frame, const std::string& axis_prefix = "");

 private:
  void append_bytes(std::span<const std::uint8_t> image, std::size_t element_bytes);

  h5::Saver& group_;
  std::string name_;
  ImageKind kind_;
  CameraInfo camera_;
  std::size_t frames_ = 0;
  std::optional<h5::ArrayWriter> images_;
};

/// Reads the images of one dataset.
class ImageReader {
 public:
  /// Records faults of the dataset in `group.faults()`; a missing one has no images. `frames`:
  /// expected number of images, or h5::unknown_length. Depth images may be stored as floats, which
  /// are multiplied by `float_depth_unit_m` and converted to counts of `camera.depth_unit_m`.
  ImageReader(const h5::Loader& group, const std::string& name, ImageKind kind,
              const CameraInfo& camera, std::size_t frames = h5::unknown_length,
              double float_depth_unit_m = 1.0);

  std::size_t frames() const { return images_ ? images_->rows() : 0; }
  /// `file` is named in errors. T: std::uint16_t for depth, else std::uint8_t. Throws data_error
  /// for a damaged or missing image.
  template <class T>
  std::vector<T> read(std::size_t index, const std::string& file) const {
    std::vector<T> image(pixels_);
    read_bytes(index, h5::bytes_of(image), file);
    return image;
  }

 private:
  void read_bytes(std::size_t index, std::span<std::uint8_t> out, const std::string& file) const;
  void read_float_depth(std::size_t index, std::span<std::uint8_t> out) const;

  std::string path_;
  std::size_t pixels_ = 0;         ///< values of an image
  double counts_per_float_ = 0.0;  ///< 0: not stored as floats
  std::optional<h5::ArrayReader> images_;
};

}  // namespace touchtrace
