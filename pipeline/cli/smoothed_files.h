#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/smooth/smooth.h"
#include "pipeline/acquire/track_file.h"

namespace touchtrace::cli {

/// Output files of a track.
struct SmoothedFiles {
  std::string name;  ///< of the input file without its extension, with a number if it is not unique
  std::filesystem::path states, flights;
};

/// Output files of each track in `folder`. Throws usage_error if one is an input.
std::vector<SmoothedFiles> smoothed_files(const std::filesystem::path& folder,
                                          const std::vector<std::string>& inputs);

/// Times at which states are written: those of the samples, or from the first to the last sample
/// every 1 / `rate_hz`, if it is not 0. Throws usage_error for more than 10 million.
std::vector<double> output_times(const TrackFile& track, double rate_hz);

/// Writes states as CSV: time, position, velocity, acceleration, upper triangle of the covariance
/// of position and velocity.
void write_states(const std::filesystem::path& file, const TrackFile& track,
                  const SmoothedTrack& smoothed, const std::vector<double>& times_s,
                  bool overwrite);

/// Writes release and landing times as CSV with their standard deviations.
void write_flights(const std::filesystem::path& file, const TrackFile& track,
                   const SmoothedTrack& smoothed, bool overwrite);

}  // namespace touchtrace::cli
