#include "pipeline/acquire/import/formats/matlab_file.h"

#include <fmt/core.h>
#include <libdeflate.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "engine/base/files.h"
#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_mat_bytes = std::size_t{256} << 20;
constexpr std::size_t mat_header_bytes = 128;
constexpr std::int32_t max_mat_size = 16384;
constexpr std::size_t max_zlib_ratio = 1032;

// Types of data elements.
constexpr std::uint32_t type_matrix = 14, type_compressed = 15;
constexpr std::uint8_t class_double = 6, class_uint32 = 13;  // of arrays of numbers

struct Element {
  std::uint32_t type = 0;
  ByteSpan data;
};

/// Reads an element. One of at most four bytes has type and size in one word.
Element read_element(ByteReader& reader) {
  const auto word = reader.number<std::uint32_t>();
  if (word >> 16 != 0) {
    const std::uint32_t size = word >> 16;
    if (size > 4) throw std::runtime_error("a data element is damaged");
    return {word & 0xffff, reader.take(4).first(size)};
  }
  const auto size = reader.number<std::uint32_t>();
  Element element{word, reader.take(size)};
  const std::size_t padding = word == type_compressed ? 0 : (8 - size % 8) % 8;
  if (!reader.is_at_end()) reader.take(padding);
  return element;
}

/// The stream's size is not stored; the buffer grows until it fits.
std::vector<std::uint8_t> inflate_zlib(ByteSpan stored) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>
      decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  const std::size_t limit = std::min(max_mat_bytes, max_zlib_ratio * stored.size());
  for (std::size_t size = std::min(limit, 8 * stored.size() + 1024);;
       size = std::min(limit, 4 * size)) {
    std::vector<std::uint8_t> bytes(size);
    std::size_t written = 0;
    const auto result = libdeflate_zlib_decompress(decompressor.get(), stored.data(), stored.size(),
                                                   bytes.data(), size, &written);
    bytes.resize(written);
    if (result == LIBDEFLATE_SUCCESS) return bytes;
    if (result != LIBDEFLATE_INSUFFICIENT_SPACE || size == limit)
      throw std::runtime_error("a compressed element is damaged or too large");
  }
}

template <class T>
cv::Mat to_doubles(ByteSpan data, int rows, int columns) {
  cv::Mat values(rows, columns, CV_64F);
  ByteReader reader(data);
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row)
      values.at<double>(row, column) = static_cast<double>(reader.number<T>());
  return values;
}

cv::Mat numbers_of(const Element& part, int rows, int columns) {
  switch (part.type) {
    case 1:
      return to_doubles<std::int8_t>(part.data, rows, columns);
    case 2:
      return to_doubles<std::uint8_t>(part.data, rows, columns);
    case 3:
      return to_doubles<std::int16_t>(part.data, rows, columns);
    case 4:
      return to_doubles<std::uint16_t>(part.data, rows, columns);
    case 5:
      return to_doubles<std::int32_t>(part.data, rows, columns);
    case 6:
      return to_doubles<std::uint32_t>(part.data, rows, columns);
    case 7:
      return to_doubles<float>(part.data, rows, columns);
    case 9:
      return to_doubles<double>(part.data, rows, columns);
    default:
      throw std::runtime_error(fmt::format("numbers of type {} are unknown", part.type));
  }
}

/// Array of an element, in double precision; nullopt if it is not an image of numbers.
std::optional<cv::Mat> read_matrix(ByteSpan data) {
  ByteReader reader(data);
  const auto flags = read_element(reader).data;
  if (flags.empty() || flags[0] < class_double || flags[0] > class_uint32) return std::nullopt;
  const auto sizes = read_element(reader).data;
  if (sizes.size() != 8) return std::nullopt;
  ByteReader extent(sizes);
  const auto rows = extent.number<std::int32_t>(), columns = extent.number<std::int32_t>();
  if (rows < 2 || columns < 2) return std::nullopt;
  if (std::max(rows, columns) > max_mat_size)
    throw std::runtime_error(fmt::format("an array of {}x{} numbers", rows, columns));
  read_element(reader);  // name
  const Element numbers = read_element(reader);
  if (static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) > numbers.data.size())
    throw std::out_of_range("an array ends early");
  return numbers_of(numbers, rows, columns);
}

bool are_whole(const cv::Mat& values) {
  return std::all_of(values.begin<double>(), values.end<double>(),
                     [](double value) { return value == std::floor(value); });
}

cv::Mat depth_of(const cv::Mat& values) {
  cv::Mat depth;
  if (!are_whole(values)) {
    values.convertTo(depth, CV_32F);
    return depth;
  }
  double min = 0.0, max = 0.0;
  cv::minMaxLoc(values, &min, &max);
  if (min < 0.0 || max > 65535.0)
    throw std::runtime_error(fmt::format("counts from {} to {} instead of 0 to 65535", min, max));
  values.convertTo(depth, CV_16U);
  return depth;
}

}  // namespace

bool is_matlab_file(const std::filesystem::path& file) { return file.extension() == ".mat"; }

cv::Mat read_matlab_depth(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, max_mat_bytes);
  ByteReader reader(bytes_of(bytes));
  const std::string header = reader.text(mat_header_bytes);
  if (header.starts_with("MATLAB 7.3"))
    throw std::runtime_error("MAT-file of version 7.3; save it with -v7");
  if (!header.ends_with("IM")) throw std::runtime_error("not a MAT-file of level 5");
  cv::Mat largest;
  while (!reader.is_at_end()) {
    Element element = read_element(reader);
    std::vector<std::uint8_t> inflated;
    if (element.type == type_compressed) {
      inflated = inflate_zlib(element.data);
      ByteReader content{ByteSpan(inflated)};
      element = read_element(content);
    }
    if (element.type != type_matrix) continue;
    const auto matrix = read_matrix(element.data);
    if (matrix && matrix->total() > largest.total()) largest = *matrix;
  }
  if (largest.empty()) throw std::runtime_error("it has no two-dimensional array of numbers");
  return depth_of(largest);
}

}  // namespace touchtrace
