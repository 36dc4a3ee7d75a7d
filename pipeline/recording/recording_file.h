#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// The recording file: HDF5, libver latest, CF units and dimension scales; every dataset is chunked
/// along its first axis and carries fletcher32 checksums.
///
/// - `/`: Conventions, schema, activity, epoch_unix_s, provenance (JSON)
/// - `/clips`: start_s, end_s, object, dropped, hand_box[n,4], object_box[n,4]
/// - `/glove0`, `/glove1`: sequence, host_time_s, counts[n,rows,cols], baseline, mask,
/// taxel_position
/// - `/camera`: sequence, device_time_s, host_time_s, color[n,h,w,3], depth[n,h,w]
/// - `/background`: color, depth of the empty scene
/// - `/board`: color, depth of the chessboard in many poses
/// - `/truth`: simulated recordings only

/// Writes a recording; the file appears, whole, with `finish`. The glove streams, clips and truth
/// are given at once, images one at a time.
class RecordingWriter {
 public:
  RecordingWriter(const std::filesystem::path& path, const CameraInfo& camera, bool overwrite);
  ~RecordingWriter();

  void append_camera_frame(const RgbdFrame& frame);
  void append_background(const RgbdFrame& frame);
  void append_board_view(const RgbdFrame& frame);
  void write_truth(const Truth& truth);
  /// `recording.camera_times` must have as many frames as were appended.
  void finish(const Recording& recording);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Opens a recording and checks it: schema, shapes, checksums as they are read, finite and
/// increasing times. Every fault is a data_error that says what is wrong and what to do. Untrusted
/// files are safe.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();

  const Recording& recording() const;
  /// False for a recording of colour images alone: its frames then have an empty `depth`.
  bool has_depth() const;
  /// Whether `read_truth` would find one.
  bool has_truth() const;
  RgbdFrame read_camera_frame(std::size_t index) const;
  std::size_t background_frames() const;
  RgbdFrame read_background(std::size_t index) const;
  std::size_t board_views() const;
  RgbdFrame read_board_view(std::size_t index) const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Truth, for evaluation only. Throws data_error if the recording has none.
Truth read_truth(const std::filesystem::path& path);
/// Whether a recording has a truth.
bool has_truth(const std::filesystem::path& path);

}  // namespace touchtrace
