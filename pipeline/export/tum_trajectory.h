#pragma once

#include <array>
#include <filesystem>

#include "pipeline/recording/labels.h"

namespace touchtrace {

/// Paths of hand.txt and object.txt in `folder`.
std::array<std::filesystem::path, 2> tum_trajectory_files(const std::filesystem::path& folder);

/// Writes the smoothed positions as TUM trajectories (readable by evo), colour camera's frame.
/// Line: `t x y z 0 0 0 1` in Unix seconds and metres; labels have no rotation. Skips labels that
/// are lost or outside the measured time. Throws if a file exists, unless `overwrite`.
void write_tum_trajectories(const std::filesystem::path& folder, const Labels& labels,
                            double epoch_unix_s, bool overwrite);

}  // namespace touchtrace
