#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Image files with their times, ordered by time as by time_order(). Times come from the file names
/// if they have stamps or dates (order_by_name); else from times.txt, timestamps.txt, times.csv or
/// timestamps.csv in `folder` or the folder above, one line per image in the order of the names;
/// else from the images' numbers and `rate_hz`. The unit of stamps is that of stamp_unit(). Throws
/// data_error if there are no times.
std::vector<StampedFile> stamped_images(const std::filesystem::path& folder,
                                        std::vector<std::filesystem::path> images, double rate_hz);

}  // namespace touchtrace
