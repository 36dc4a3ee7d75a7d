#pragma once

#include <string>

#include "pipeline/acquire/import/source_camera.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {

/// Pixels of a colour image, red first, row by row.
std::vector<std::uint8_t> rgb_values(const cv::Mat& bgr);

/// Range of images "first:last", both included.
struct FrameRange {
  std::size_t first = 0, last = 0;
};

/// Throws usage_error for another text.
FrameRange parse_frame_range(const std::string& text);

/// Appends depth images of a source, and the colour images nearest to them in time, as images of
/// the empty scene. At most 100, evenly spaced. Throws data_error if an image is damaged or of
/// another format than the recording's.
void append_background(RecordingWriter& writer, const ImportSource& source,
                       const SourceCamera& camera, FrameRange range);

}  // namespace touchtrace
