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
/// estimated. Throws data_error if a file is invalid or has too few samples for an estimate.
std::vector<SmoothInput> read_smooth_inputs(const std::vector<std::string>& paths,
                                            const std::vector<SmoothedFiles>& files,
                                            double sigma_m);

}  // namespace touchtrace::cli
