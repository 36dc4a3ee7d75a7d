#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Image files with their times, ordered by time as by time_order(). Times come from the file names
/// if all of these end with a stamp (a number with a fraction, or with 13 digits or more); else
/// from times.txt, timestamps.txt, times.csv or timestamps.csv in `folder` or the folder above, one
/// line per image in the order of their numbers; else from the images' numbers and `rate_hz`. The
/// unit of stamps is that of stamp_unit(). Throws data_error if there are no times.
std::vector<StampedFile> stamped_images(const std::filesystem::path& folder,
                                        std::vector<std::filesystem::path> images, double rate_hz);

/// Sorts by the last number in each name, then by name.
void sort_by_number(std::vector<std::filesystem::path>& images);

}  // namespace touchtrace
