#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/acquire/import/source/source.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Numbers of frames in the files' names (order_by_name). Empty if there are none, or if they do
/// not increase.
std::vector<std::uint64_t> frame_numbers(const std::vector<StampedFile>& files);

/// Counter of a camera's frames: the numbers in units of their greatest common step. Empty if fewer
/// than half of the numbers increase by this step: they are then not numbers of frames.
std::vector<std::uint64_t> frame_counter(const std::vector<std::uint64_t>& numbers);

/// Warns if images whose times are their numbers over `rate_hz` have different numbers in colour
/// and depth, or numbers that increase as times do.
void check_numbers(const ImportSource& source, double rate_hz);

/// Throws data_error if no depth image has a colour image at its time.
void require_pairs(const ImportSource& source);

}  // namespace touchtrace
