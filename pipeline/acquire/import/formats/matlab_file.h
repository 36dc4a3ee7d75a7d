#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace touchtrace {

/// Whether the file's extension is .mat.
bool is_matlab_file(const std::filesystem::path& file);

/// Depth image of the largest two-dimensional array of numbers in a MAT-file of level 5 (MATLAB's
/// -v6 and -v7): 16-bit counts of integers and of whole numbers, metres of other floating-point
/// numbers. Format: "MAT-File Format", MathWorks. Throws std::exception for a file that is invalid,
/// of another level or larger than 256 MiB. Safe for untrusted files.
cv::Mat read_matlab_depth(const std::filesystem::path& file);

}  // namespace touchtrace
