#pragma once

#include <filesystem>
#include <vector>

namespace touchtrace {

/// Depth of 16-bit images in the format of the TUM RGB-D benchmark.
inline constexpr double tum_counts_per_m = 5000.0;

struct StampedFile {
  double time_s;
  std::filesystem::path path;
};

/// Files of `list`, rgb.txt or depth.txt, ordered by time as by time_order(). The unit of the
/// stamps is that of stamp_unit(). Throws data_error for a line that is not `timestamp path` and
/// for a path outside the folder.
std::vector<StampedFile> read_tum_list(const std::filesystem::path& folder, const char* list);

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
