#pragma once

#include <memory>
#include <optional>

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Colour and depth images of one group, one frame a chunk. Depth is left out if the first frame
/// has none.
class ImageSeriesWriter {
 public:
  ImageSeriesWriter(h5::Saver group, const CameraInfo& camera);

  /// Throws failure if an image has another size than the camera.
  void append(const RgbdFrame& frame);
  std::size_t frames() const { return frames_; }
  h5::Saver& group() { return group_; }
  /// Hangs the axes on the images; `time`: of the frames, else they are counted.
  void finish(std::optional<h5::Axis> time = std::nullopt);

 private:
  void create(const RgbdFrame& first);

  h5::Saver group_;
  CameraInfo camera_;
  std::size_t frames_ = 0;
  std::optional<h5::ArrayWriter> color_, depth_;
};

class ImageSeriesReader {
 public:
  ImageSeriesReader(const h5::Loader& group, const CameraInfo& camera);

  std::size_t frames() const { return color_ ? color_->rows() : 0; }
  bool has_depth() const { return depth_.has_value(); }
  /// Throws data_error for a damaged image. `depth` stays empty where there is none.
  RgbdFrame read(std::size_t index, const std::string& file) const;

 private:
  std::optional<h5::ArrayReader> color_, depth_;
};

}  // namespace touchtrace
