#pragma once

#include <filesystem>
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

  void append_camera_frame(const RgbdFrame& frame);
  void append_background(const RgbdFrame& frame);
  void append_board_view(const RgbdFrame& frame);
  void write_truth(const Truth& truth);
  /// `recording.camera_times` has one entry per appended camera frame.
  void finish(const Recording& recording);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads a recording. The constructor loads everything except images and truth, and validates it:
/// schema, types, shapes, checksums, finite and increasing times. Throws data_error that lists all
/// faults. Safe for untrusted files.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();

  /// Validates a file like the constructor, and also its truth.
  static void validate(const std::filesystem::path& path);

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

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads the ground truth, for evaluation only. Throws data_error if the recording has none.
Truth read_truth(const std::filesystem::path& path);
bool has_truth(const std::filesystem::path& path);

}  // namespace touchtrace
