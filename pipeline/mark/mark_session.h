#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/mark/boxes.h"
#include "pipeline/recording/clip_range.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {

/// Boxes of hand and object that are being drawn into a recording.
class MarkSession {
 public:
  /// Writes to `output`, which may be the recording itself. Throws data_error for an invalid
  /// recording or one without clips or images, and usage_error if `output` is another file that
  /// exists, unless `overwrite`.
  MarkSession(std::filesystem::path recording, std::filesystem::path output, bool overwrite);

  const Recording& recording() const { return reader_.recording(); }
  /// Camera frames of a clip.
  IndexRange frames_of(const Clip& clip) const;
  /// Image size, and for each clip with camera frames its index and object, its first and last
  /// frame, and its boxes, if any.
  nlohmann::json state() const;
  /// Colour image of a camera frame as JPEG. Throws data_error if it does not exist.
  std::string jpeg(std::size_t frame) const;
  /// Writes the boxes into the file. Throws data_error for implausible boxes, then nothing is
  /// written.
  void save(const std::vector<ClipBoxes>& boxes);

 private:
  std::filesystem::path path_, output_;
  bool overwrite_;
  RecordingReader reader_;
  std::map<std::size_t, ClipBoxes> boxes_;  ///< by clip
};

}  // namespace touchtrace
