#pragma once

#include <filesystem>
#include <vector>

namespace touchtrace {

/// A colour image and the depth image nearest in time.
struct TumPair {
  double color_time_s, depth_time_s;
  std::filesystem::path color, depth;
};

/// All pairs of a TUM RGB-D folder whose stamps are within 20 ms, each depth image once, in the
/// order of time. Throws data_error for a line that is not `timestamp path`, or a path that leads
/// out of the folder.
std::vector<TumPair> tum_pairs(const std::filesystem::path& folder);

/// The pairs that are looked at: all of a short video, of a long one successive frames here and
/// there, so that their motion shows.
std::vector<TumPair> chosen_pairs(const std::vector<TumPair>& all);

/// The files of those.
std::vector<std::filesystem::path> tum_files(const std::filesystem::path& folder);

}  // namespace touchtrace
