#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Interval of a recording [s] on its clock, which starts at `epoch_s` of the source's clock.
struct RecordedTime {
  double first_s = 0.0, last_s = 0.0, epoch_s = 0.0;
};

/// Reads clips from a table with the columns start_s, end_s and, optionally, object. Times are on
/// the source's clock; if that is Unix time, also in seconds since the first image. Throws
/// data_error for clips that are empty, overlap or lie outside the recording.
std::vector<Clip> read_clips(const std::filesystem::path& file, const RecordedTime& time,
                             const std::string& object);

}  // namespace touchtrace
