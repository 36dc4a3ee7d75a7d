#pragma once

#include <array>
#include <filesystem>

#include "pipeline/recording/labels.h"

namespace touchtrace {

/// hand.txt and object.txt in `folder`.
std::array<std::filesystem::path, 2> tum_trajectory_files(const std::filesystem::path& folder);

/// Writes those files into `folder`: TUM trajectories, as evo reads them, of the
/// smoothed positions in the colour camera's frame. A line is `t x y z 0 0 0 1`: Unix seconds,
/// metres, and no rotation, for labels have none. Labels that say that they are lost, or that lie
/// outside the measured time, are left out. Refuses files that exist unless `overwrite`.
void write_tum_trajectories(const std::filesystem::path& folder, const Labels& labels,
                            double epoch_unix_s, bool overwrite);

}  // namespace touchtrace
