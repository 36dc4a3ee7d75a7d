#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Array of numbers in row-major order, little-endian.
struct NumpyArray {
  std::vector<std::size_t> shape;
  std::string type;  ///< NumPy's letter and bytes: "u2", "f4", ...
  std::string data;
  double per_second = 0.0;  ///< elements per second of dates, which at() has in seconds; 0: numbers

  std::size_t size() const;  ///< number of elements
  double at(std::size_t index) const;
};

/// Elements in row-major order of an array whose first index runs fastest.
std::string row_major(std::string_view data, const std::vector<std::size_t>& shape,
                      std::size_t bytes_per_element);

/// The array with this axis as the first one; the others keep their order.
NumpyArray moved_to_front(const NumpyArray& array, std::size_t axis);

/// Whether the file's extension is .npy or .npz.
bool is_numpy_file(const std::filesystem::path& file);

/// Arrays of an .npz file by their name: those of `wanted`, or all if it is empty. Throws
/// data_error for a file that is invalid or larger than 4 GiB, and for arrays of other types than
/// numbers and dates.
std::map<std::string, NumpyArray> read_numpy_archive(const std::filesystem::path& file,
                                                     const std::vector<std::string>& wanted = {});

/// Array of an .npy file; of an .npz file the only one of two axes, else the first. Throws
/// data_error.
NumpyArray read_numpy_array(const std::filesystem::path& file);

/// Largest width and height of an image.
inline constexpr std::size_t max_array_image_size = 16384;

/// Depth image of a 2-D array: 16-bit counts of integers, metres of floating-point numbers.
/// `any_whole_number`: floating-point numbers that are all whole are counts, too. Throws
/// std::runtime_error for another shape and for counts of more than 16 bits.
cv::Mat to_depth(const NumpyArray& array, bool any_whole_number = false);

}  // namespace touchtrace
