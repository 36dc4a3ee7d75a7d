#include "pipeline/acquire/import/formats/matlab_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <libdeflate.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/import/formats/byte_reader.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_mat_bytes = std::size_t{1} << 30;
constexpr std::size_t mat_header_bytes = 128;
constexpr std::size_t max_zlib_ratio = 1032;

// Types of data elements.
constexpr std::uint32_t type_matrix = 14, type_compressed = 15;
constexpr std::uint8_t first_number_class = 6, last_number_class = 15;  // double to uint64

/// Whether an array of this name and shape is read.
using IsWanted =
    std::function<bool(const std::string& name, const std::vector<std::size_t>& shape)>;

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

/// Type of the numbers in a data element.
struct NumberType {
  std::uint32_t type;
  const char* numpy_name;
  std::size_t bytes;
};

constexpr NumberType number_types[] = {{1, "i1", 1},  {2, "u1", 1}, {3, "i2", 2}, {4, "u2", 2},
                                       {5, "i4", 4},  {6, "u4", 4}, {7, "f4", 4}, {9, "f8", 8},
                                       {12, "i8", 8}, {13, "u8", 8}};

const NumberType& number_type(std::uint32_t type) {
  const auto* found = std::ranges::find(number_types, type, &NumberType::type);
  if (found == std::end(number_types))
    throw std::runtime_error(fmt::format("numbers of type {} are unknown", type));
  return *found;
}

/// Product of the sizes. Throws std::exception for a negative size and for too many numbers.
std::size_t count_of(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size > max_mat_bytes / std::max<std::size_t>(1, count))
      throw std::runtime_error(fmt::format("an array of {} numbers", fmt::join(shape, "x")));
    count *= size;
  }
  return count;
}

struct NamedArray {
  std::string name;
  NumpyArray values;
};

std::vector<std::size_t> read_shape(ByteSpan data) {
  std::vector<std::size_t> shape;
  for (ByteReader reader(data); !reader.is_at_end();)
    shape.push_back(static_cast<std::size_t>(reader.number<std::int32_t>()));
  return shape;
}

/// Array of an element; nullopt if it does not hold numbers or is not wanted.
std::optional<NamedArray> read_array(ByteSpan data, const IsWanted& is_wanted) {
  ByteReader reader(data);
  const auto flags = read_element(reader).data;
  if (flags.empty() || flags[0] < first_number_class || flags[0] > last_number_class)
    return std::nullopt;
  NamedArray array;
  array.values.shape = read_shape(read_element(reader).data);
  if (array.values.shape.size() < 2) throw std::runtime_error("an array has less than two axes");
  const ByteSpan name = read_element(reader).data;
  array.name.assign(name.begin(), name.end());
  if (!is_wanted(array.name, array.values.shape)) return std::nullopt;
  const Element numbers = read_element(reader);
  const NumberType& type = number_type(numbers.type);
  const std::size_t count = count_of(array.values.shape);
  if (count > numbers.data.size() / type.bytes) throw std::out_of_range("an array ends early");
  const std::string_view used(reinterpret_cast<const char*>(numbers.data.data()),
                              count * type.bytes);
  array.values.type = type.numpy_name;
  array.values.data = row_major(used, array.values.shape, type.bytes);
  return array;
}

/// Arrays of numbers in a MAT-file of level 5. Throws std::exception.
std::vector<NamedArray> read_arrays(const std::filesystem::path& file, const IsWanted& is_wanted) {
  const std::string bytes = read_file(file, max_mat_bytes);
  ByteReader reader(bytes_of(bytes));
  const std::string header = reader.text(mat_header_bytes);
  if (header.starts_with("MATLAB 7.3"))
    throw std::runtime_error("MAT-file of version 7.3; save it with -v7");
  if (!header.ends_with("IM")) throw std::runtime_error("not a MAT-file of level 5");
  std::vector<NamedArray> arrays;
  while (!reader.is_at_end()) {
    Element element = read_element(reader);
    std::vector<std::uint8_t> inflated;
    if (element.type == type_compressed) {
      inflated = inflate_zlib(element.data);
      ByteReader content{ByteSpan(inflated)};
      element = read_element(content);
    }
    if (element.type != type_matrix) continue;
    if (auto array = read_array(element.data, is_wanted)) arrays.push_back(std::move(*array));
  }
  return arrays;
}

/// Image of at least 2x2 numbers.
bool is_image(const std::vector<std::size_t>& shape) {
  return shape.size() == 2 && std::ranges::min(shape) >= 2 &&
         std::ranges::max(shape) <= max_array_image_size;
}

}  // namespace

bool is_matlab_file(const std::filesystem::path& file) { return file.extension() == ".mat"; }

cv::Mat read_matlab_depth(const std::filesystem::path& file) {
  const auto images =
      read_arrays(file, [](const auto&, const auto& shape) { return is_image(shape); });
  if (images.empty()) throw std::runtime_error("it has no two-dimensional array of numbers");
  const auto size = [](const NamedArray& image) { return image.values.size(); };
  return to_depth(std::ranges::max(images, {}, size).values, true);
}

std::map<std::string, NumpyArray> read_matlab_arrays(const std::filesystem::path& file,
                                                     const std::vector<std::string>& wanted) {
  std::map<std::string, NumpyArray> arrays;
  try {
    for (auto& array : read_arrays(file, [&](const std::string&name, const auto&) {
           return std::ranges::find(wanted, name) != wanted.end();
         }))
      arrays[array.name] = std::move(array.values);
  } catch (const std::exception& error) {
    throw data_error(fmt::format("{}: {}", file.string(), error.what()),
                     "give a MAT-file of level 5 (MATLAB's -v6 or -v7)");
  }
  return arrays;
}

}  // namespace touchtrace
