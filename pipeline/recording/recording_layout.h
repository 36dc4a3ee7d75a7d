#pragma once

#include "pipeline/recording/h5_archive.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Groups of the camera's streams, and the names of their images, by schema.
struct CameraLayout {
  /// `schema`: recording_schema or recording_schema_1.
  CameraLayout(const h5::Loader& root, const std::string& schema);

  bool is_schema_1;
  h5::Loader color, depth, background, board;
  std::string color_images, depth_images;
};

/// Contents of a recording file before colour and depth images are paired.
struct RecordingStreams {
  Recording recording;  ///< without camera_times
  CameraTimes color_times, depth_times;
  double float_depth_unit_m = 1.0;  ///< of depth images that are stored as floats
};

/// Reads everything except images and truth, and validates it. Records faults in `root.faults()`.
RecordingStreams read_streams(const h5::Loader& root, const CameraLayout& layout);

/// Host time that becomes 0: the first stamp of all streams if it is above 1e6 s, such as a Unix
/// time, else 0.
double clock_shift_s(const h5::Loader& root);

}  // namespace touchtrace
