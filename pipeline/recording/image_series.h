#pragma once

#include <memory>
#include <optional>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Writes the colour and depth images of one group, one image per chunk; no depth if the first
/// frame has none.
class ImageSeriesWriter {
 public:
  ImageSeriesWriter(h5::Saver group, const CameraInfo& camera);

  /// Throws failure if the size of an image is not that of the camera.
  void append(const RgbdFrame& frame);
  std::size_t frames() const { return frames_; }
  h5::Saver& group() { return group_; }
  /// Attaches dimension scales and closes; `time`: scale of the first axis, default: the index.
  void finish(std::optional<h5::Axis> time = std::nullopt);

 private:
  void create(const RgbdFrame& first);

  h5::Saver group_;
  CameraInfo camera_;
  std::size_t frames_ = 0;
  std::optional<h5::ArrayWriter> color_, depth_;
};

/// Reads the images of one group.
class ImageSeriesReader {
 public:
  /// Records faults of the datasets in `group.faults()`.
  ImageSeriesReader(const h5::Loader& group, const CameraInfo& camera);

  std::size_t frames() const { return color_ ? color_->rows() : 0; }
  bool has_depth() const { return depth_.has_value(); }
  /// `file` is named in errors. Throws data_error for a damaged or missing image. `depth` is empty
  /// if the file has none.
  RgbdFrame read(std::size_t index, const std::string& file) const;

 private:
  void read(const h5::ArrayReader& images, std::size_t index, std::span<std::uint8_t> out,
            const std::string& name) const;

  std::string path_;
  std::optional<h5::ArrayReader> color_, depth_;
};

}  // namespace touchtrace
