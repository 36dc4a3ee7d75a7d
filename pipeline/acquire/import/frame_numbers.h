#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/acquire/import/source.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {

/// Last number in a file's name, with its fraction; empty if there is none.
std::string number_in_name(const std::filesystem::path& file);

/// Whether the last number in a file's name is a time stamp: it has a fraction, or 13 digits or
/// more.
bool has_stamp(const std::filesystem::path& file);

/// Last number in each file's name. Empty if a file has none or a stamp, or if the numbers do not
/// increase.
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
