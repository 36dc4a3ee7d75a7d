#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/acquire/import/gloves/glove_file.h"

namespace touchtrace {

/// Frames of a file in the order of their times.
struct GloveTimes {
  std::vector<std::size_t> frames;      ///< indices in the file, without those that run backward
  std::vector<double> time_s;           ///< [frames], the file's clock
  std::vector<std::uint64_t> sequence;  ///< [frames], see glove_times()
  double rate_hz = 0.0;                 ///< mean, without lost frames
};

/// Converts the stamps of a file to seconds; see stamp_unit(). Frames that share a stamp are spread
/// evenly over the time until the next one, if that is over 10 % of them. The frames have the
/// file's numbers if these count them; else, if nearly all intervals are whole periods and at most
/// 10 % of the frames are missing, missing frames are counted by the stamps; else there is one
/// number per frame, and more over pauses only. Frames without stamps have the times of their
/// numbers at the user's rate, so that lost ones take time, too. Reports what is not obvious.
/// Throws data_error for stamps without a plausible rate and for more than 10^6 s.
GloveTimes glove_times(const GloveFile& file);

}  // namespace touchtrace
