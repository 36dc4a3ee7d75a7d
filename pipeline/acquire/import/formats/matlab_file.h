#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "pipeline/acquire/import/formats/numpy_file.h"

namespace touchtrace {

/// Whether the file's extension is .mat.
bool is_matlab_file(const std::filesystem::path& file);

/// Depth image of the largest two-dimensional array of numbers in a MAT-file of level 5 (MATLAB's
/// -v6 and -v7): 16-bit counts of integers and of whole numbers, metres of other floating-point
/// numbers. Format: "MAT-File Format", MathWorks. Throws std::exception for a file that is invalid,
/// of another level or larger than 1 GiB. Safe for untrusted files.
cv::Mat read_matlab_depth(const std::filesystem::path& file);

/// Arrays of numbers by their name: those of `wanted` that a MAT-file of level 5 has. Throws
/// data_error. Safe for untrusted files.
std::map<std::string, NumpyArray> read_matlab_arrays(const std::filesystem::path& file,
                                                     const std::vector<std::string>& wanted);

}  // namespace touchtrace
