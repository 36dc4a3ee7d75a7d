#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/smooth/track.h"
#include "pipeline/acquire/track_columns.h"

namespace touchtrace {

/// Measured positions of a body, read from a text file.
struct TrackFile {
  static constexpr std::size_t max_rows = 1'000'000;

  std::filesystem::path file;
  /// Time of the track's origin on the file's clock: a whole number of seconds, because a double
  /// resolves seconds since 1970 to 0.2 us only. 0 for small times.
  std::int64_t origin_s = 0;
  Track track;                  ///< sigmas are NaN if the file has none
  bool has_sigmas = false;      ///< whether the file has them
  std::size_t num_skipped = 0;  ///< rows without a position
};

/// Reads a CSV file or a TUM trajectory; README.md describes the formats. Throws data_error with
/// all faulty lines, or if there are more than `max_rows` or no positions.
TrackFile read_track(const std::filesystem::path& file, const TrackOptions& options = {});

/// Reads flights, columns `release_s` and `landing_s`, on the clock of `track`'s file. Throws
/// data_error with all faulty lines, or for flights that overlap or are outside the track's time.
std::vector<Flight> read_flights(const std::filesystem::path& file, const TrackFile& track);

/// A time of a track on its file's clock [s]: the shortest text that gives the same double, or to
/// the nanosecond if the origin is not 0.
std::string time_text(std::int64_t origin_s, double time_s);

/// Standard deviation of each axis' white errors, from third differences, in which a smooth motion
/// nearly vanishes: their median absolute value over that of errors of unit variance. At least a
/// tenth of the largest axis'. NaN for fewer than 13 samples or if most differences are zero but
/// for rounding.
Eigen::Vector3d estimate_white_sigma(const Track& track);

}  // namespace touchtrace
