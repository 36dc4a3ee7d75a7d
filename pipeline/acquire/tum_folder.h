#pragma once

#include <filesystem>
#include <vector>

namespace touchtrace {

/// Colour image and the depth image nearest in time.
struct TumPair {
  double color_time_s, depth_time_s;
  std::filesystem::path color, depth;
};

/// Pairs of a TUM RGB-D folder with time stamps at most 20 ms apart, ordered by time; each depth
/// image is used once. Throws data_error for a line that is not `timestamp path`, for a path
/// outside the folder, and if there is no pair.
std::vector<TumPair> read_tum_pairs(const std::filesystem::path& folder);

/// Pairs to search for boards: all if there are 80 or fewer, else 40 evenly spaced groups of two
/// successive pairs, so that motion between frames can be measured.
std::vector<TumPair> select_tum_pairs(const std::vector<TumPair>& all);

/// Files that are read: both lists and the images of the selected pairs.
std::vector<std::filesystem::path> tum_files(const std::filesystem::path& folder);

}  // namespace touchtrace
