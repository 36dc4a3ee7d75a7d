#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Writes a recording file (layout: pipeline/recording/README.md). The file appears, complete, when
/// finish() returns; an interrupted writer leaves none. Throws failure.
class RecordingWriter {
 public:
  RecordingWriter(const std::filesystem::path& path, const CameraInfo& camera, bool overwrite);
  ~RecordingWriter();

  void append_color(const std::vector<std::uint8_t>& image);
  void append_depth(const std::vector<std::uint16_t>& image);
  /// MaskValue of each pixel of the colour image with index `color_frame`.
  void append_mask(std::size_t color_frame, const std::vector<std::uint8_t>& mask);
  /// Appends the colour image, and the depth image and the mask if there are.
  void append_camera_frame(const RgbdFrame& frame);
  void append_background(const RgbdFrame& frame);
  void append_board_view(const RgbdFrame& frame);
  void write_truth(const Truth& truth);
  /// `recording.camera_times` has one entry per depth image, `color_times` one per colour image.
  void finish(const Recording& recording);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads a recording. The constructor loads everything except images and truth,
/// and validates it: schema, types, shapes, checksums, finite times. Camera frames are pairs of a
/// depth image and the colour image nearest in time; in a recording without depth they are the
/// colour images. Host times above 1e6 s, such as Unix time, are shifted to begin at 0. Throws
/// data_error that lists all faults. Safe for untrusted files.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();

  /// Validates a file like the constructor, and also its truth.
  static void validate(const std::filesystem::path& path);

  const std::string& path() const;
  const Recording& recording() const;
  /// False if only colour was recorded; RgbdFrame::depth is then empty.
  bool has_depth() const;
  bool has_truth() const;
  /// Images. Thread-safe. Throw data_error for a damaged image.
  RgbdFrame read_camera_frame(std::size_t index) const;
  std::size_t background_frames() const;
  RgbdFrame read_background(std::size_t index) const;
  std::size_t board_views() const;
  RgbdFrame read_board_view(std::size_t index) const;

  /// Numbers of images that the file stores, with those that have no partner.
  std::size_t color_images() const;
  std::size_t depth_images() const;
  /// Host time of the file that recording() calls 0.
  double clock_shift_s() const;
  /// Index of a camera frame's colour image.
  std::size_t color_image_of(std::size_t camera_frame) const;
  /// Colour images that have a mask, in increasing order.
  std::vector<std::size_t> masked_color_images() const;
  /// Camera frames whose colour image has a mask, in increasing order.
  std::vector<std::size_t> masked_camera_frames() const;
  /// MaskValue of each pixel; empty if the colour image has no mask.
  std::vector<std::uint8_t> read_mask(std::size_t color_image) const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Copies a recording with new clips and masks, without loading its images at once. Clip::box_frame
/// and the keys of `masks` are indices of colour images; times are those of RecordingReader.
/// `masks` (MaskValue of each colour pixel) are added to those of the recording, and replace the
/// masks of the same images. `from` and `to` may be the same file. Throws data_error for an invalid
/// file and usage_error if `to` exists, unless `overwrite`.
void rewrite_clips(const std::filesystem::path& from, const std::filesystem::path& to,
                   const std::vector<Clip>& clips,
                   const std::map<std::size_t, std::vector<std::uint8_t>>& masks, bool overwrite);

/// Reads the ground truth, for evaluation only. Throws data_error if the recording has none.
Truth read_truth(const std::filesystem::path& path);
bool has_truth(const std::filesystem::path& path);

}  // namespace touchtrace
