#pragma once

#include <string>
#include <vector>

#include "pipeline/acquire/track_file.h"
#include "pipeline/cli/smoothed_files.h"

namespace touchtrace::cli {

/// Track to smooth.
struct SmoothInput {
  TrackFile track;  ///< with standard deviations
  SmoothedFiles files;
  std::string sigma_source;  ///< "file", "option" or "data"
};

/// Reads tracks. Standard deviations are those of the file, else `sigma_m`; if that is 0, they are
/// estimated. If at least 30 % of 20 positions or more repeat the one before them at most three
/// times in a row, as where a program writes faster than a tracker measures, skips these with a
/// warning. Throws data_error if a file is invalid or has too few samples for an estimate.
std::vector<SmoothInput> read_smooth_inputs(const std::vector<std::string>& paths,
                                            const std::vector<SmoothedFiles>& files,
                                            const TrackOptions& options, double sigma_m);

/// Runs of positions that are equal to the one before them: index of the first repeat, and number.
struct RepeatedRun {
  std::size_t first, count;
};
std::vector<RepeatedRun> find_repeats(const Track& track);

/// More repeats in a row are a tracker that sees nothing and holds its last value: positions that
/// are rounded to millimetres, of a body at rest with noise of 1 mm, are the same five times in a
/// row by chance once in 10^6 samples.
inline constexpr std::size_t max_held_repeats = 3;

}  // namespace touchtrace::cli
