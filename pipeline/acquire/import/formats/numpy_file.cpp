#include "pipeline/acquire/import/formats/numpy_file.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <numeric>
#include <regex>
#include <stdexcept>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/acquire/import/formats/byte_reader.h"
#include "pipeline/acquire/import/formats/zip_file.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_searched_arrays = 16;
constexpr std::uintmax_t max_file_bytes = std::uintmax_t{1} << 32;
constexpr std::size_t max_header_bytes = 4096;

template <class T>
double element(const std::string& data, std::size_t index) {
  T value;
  std::memcpy(&value, data.data() + index * sizeof(T), sizeof(T));
  return static_cast<double>(value);
}

double half_element(const std::string& data, std::size_t index) {
  Eigen::half value;
  std::memcpy(&value, data.data() + index * sizeof(value), sizeof(value));
  return static_cast<double>(static_cast<float>(value));
}

struct ElementType {
  const char* name;
  std::size_t bytes;
  double (*read)(const std::string& data, std::size_t index);
};

constexpr ElementType element_types[] = {
    {"u1", 1, element<std::uint8_t>},  {"u2", 2, element<std::uint16_t>},
    {"u4", 4, element<std::uint32_t>}, {"u8", 8, element<std::uint64_t>},
    {"i1", 1, element<std::int8_t>},   {"i2", 2, element<std::int16_t>},
    {"i4", 4, element<std::int32_t>},  {"i8", 8, element<std::int64_t>},
    {"f4", 4, element<float>},         {"f8", 8, element<double>},
    {"f2", 2, half_element},           {"b1", 1, element<std::uint8_t>}};

const ElementType& element_type(const std::string& name) {
  const auto* found = std::ranges::find(element_types, name, &ElementType::name);
  if (found == std::end(element_types))
    throw std::runtime_error(fmt::format("arrays of type '{}' are not supported", name));
  return *found;
}

std::vector<std::size_t> parse_shape(const std::string& text) {
  std::vector<std::size_t> shape;
  std::size_t count = 1;
  static const std::regex digits("[0-9]{1,10}");
  for (std::sregex_iterator match(text.begin(), text.end(), digits), end; match != end; ++match) {
    shape.push_back(std::stoull(match->str()));
    const auto extent = std::max<std::size_t>(1, shape.back());
    if (extent > max_file_bytes / count) throw std::runtime_error("the array is too large");
    count *= extent;
  }
  return shape;
}

/// Reverses the bytes of each element.
void swap_bytes(std::string& data, std::size_t bytes) {
  for (auto at = data.begin(); at != data.end(); at += static_cast<std::ptrdiff_t>(bytes))
    std::reverse(at, at + static_cast<std::ptrdiff_t>(bytes));
}

double units_per_second(const std::string& unit) {
  for (const auto& [name, per_second] :
       {std::pair{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}})
    if (unit == name) return per_second;
  throw std::runtime_error(fmt::format("dates in units of '{}' are not supported", unit));
}

/// Type and order of the elements of an .npy file.
struct NumpyHeader {
  std::vector<std::size_t> shape;
  std::string type;
  double per_second = 0.0;
  bool is_big_endian = false, is_first_index_fastest = false;
};

NumpyHeader parse_header(const std::string& header) {
  static const std::regex descr("'descr': '([<>|])([a-zA-Z][0-9])(?:\\[([a-z]+)\\])?'"),
      shape("'shape': \\(([0-9, ]*)\\)");
  std::smatch type, sizes;
  if (!std::regex_search(header, type, descr) || !std::regex_search(header, sizes, shape))
    throw std::runtime_error("not an array of numbers: " + header);
  NumpyHeader parsed{parse_shape(sizes[1]), type[2]};
  parsed.is_big_endian = type[1] == ">";
  parsed.is_first_index_fastest = header.find("'fortran_order': True") != std::string::npos;
  if (parsed.type != "M8") return parsed;
  parsed.type = "i8";
  parsed.per_second = units_per_second(type[3]);
  return parsed;
}

/// Parses an .npy file.
NumpyArray parse_array(const std::string& bytes) {
  ByteReader reader(bytes_of(bytes));
  if (reader.text(6) != "\x93NUMPY") throw std::runtime_error("not a NumPy array");
  const int version = reader.number<std::uint16_t>() & 0xff;
  const std::size_t length =
      version == 1 ? reader.number<std::uint16_t>() : reader.number<std::uint32_t>();
  if (length > max_header_bytes) throw std::runtime_error("the array's header is too long");
  const std::string header = reader.text(length);
  const NumpyHeader parsed = parse_header(header);
  const std::size_t bytes_each = element_type(parsed.type).bytes;
  NumpyArray array{parsed.shape, parsed.type, {}, parsed.per_second};
  array.data = reader.text(array.size() * bytes_each);
  if (parsed.is_big_endian) swap_bytes(array.data, bytes_each);
  if (parsed.is_first_index_fastest) array.data = row_major(array.data, array.shape, bytes_each);
  return array;
}

/// Calls `read`; adds the file's name to errors.
template <class Read>
auto read_named(const std::filesystem::path& file, Read&& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read {}: {}", file.string(), error.what()),
                     "write arrays with numpy.save or numpy.savez");
  }
}

/// The only array of two axes, such as an image, else the first array.
NumpyArray image_or_first(const std::string& archive) {
  const auto entries = zip_entries(archive);
  if (entries.empty()) throw std::runtime_error("it has no arrays");
  std::vector<NumpyArray> images;
  for (std::size_t i = 0; i < std::min(entries.size(), max_searched_arrays); ++i) try {
      auto array = parse_array(zip_content(archive, entries[i]));
      if (array.shape.size() == 2) images.push_back(std::move(array));
    } catch (const std::exception&) {
      continue;  // not an array of numbers
    }
  return images.size() == 1 ? std::move(images[0]) : parse_array(zip_content(archive, entries[0]));
}

}  // namespace

std::string row_major(std::string_view data, const std::vector<std::size_t>& shape,
                      std::size_t bytes) {
  std::string result(data.size(), '\0');
  std::vector<std::size_t> index(shape.size(), 0);
  for (std::size_t at = 0; at < data.size(); at += bytes) {
    std::size_t to = 0;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) to = to * shape[axis] + index[axis];
    std::copy_n(&data[at], bytes, &result[to * bytes]);
    for (std::size_t axis = 0; axis < shape.size() && ++index[axis] == shape[axis]; ++axis)
      index[axis] = 0;
  }
  return result;
}

NumpyArray moved_to_front(const NumpyArray& array, std::size_t axis) {
  NumpyArray moved{array.shape, array.type, {}, array.per_second};
  std::rotate(moved.shape.begin(), moved.shape.begin() + static_cast<std::ptrdiff_t>(axis),
              moved.shape.begin() + static_cast<std::ptrdiff_t>(axis) + 1);
  if (array.size() == 0) return moved;
  const std::size_t frames = array.shape[axis], bytes = array.data.size() / array.size();
  std::size_t inner = bytes;  // bytes of a step along the axis
  for (std::size_t i = axis + 1; i < array.shape.size(); ++i) inner *= array.shape[i];
  const std::size_t outer = array.data.size() / (inner * frames);
  moved.data.reserve(array.data.size());
  for (std::size_t frame = 0; frame < frames; ++frame)
    for (std::size_t i = 0; i < outer; ++i)
      moved.data.append(array.data, (i * frames + frame) * inner, inner);
  return moved;
}

std::size_t NumpyArray::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

double NumpyArray::at(std::size_t index) const {
  const double value = element_type(type).read(data, index);
  return per_second > 0.0 ? value / per_second : value;
}

bool is_numpy_file(const std::filesystem::path& file) {
  return file.extension() == ".npy" || file.extension() == ".npz";
}

std::map<std::string, NumpyArray> read_numpy_archive(const std::filesystem::path& file,
                                                     const std::vector<std::string>& wanted) {
  const std::string bytes = read_file(file, max_file_bytes);
  return read_named(file, [&] {
    std::map<std::string, NumpyArray> arrays;
    for (const ZipEntry& entry : zip_entries(bytes)) {
      const std::string name = std::filesystem::path(entry.name).stem();
      if (wanted.empty() || std::ranges::find(wanted, name) != wanted.end())
        arrays[name] = parse_array(zip_content(bytes, entry));
    }
    return arrays;
  });
}

NumpyArray read_numpy_array(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, max_file_bytes);
  return read_named(file, [&] {
    if (file.extension() != ".npz") return parse_array(bytes);
    return image_or_first(bytes);
  });
}

cv::Mat to_depth(const NumpyArray& array, bool any_whole_number) {
  const auto& shape = array.shape;
  if (shape.size() != 2 || std::ranges::max(shape) > max_array_image_size || array.size() == 0)
    throw std::runtime_error("not an array [height, width]");
  cv::Mat values(static_cast<int>(shape[0]), static_cast<int>(shape[1]), CV_64F), depth;
  for (std::size_t i = 0; i < array.size(); ++i) values.ptr<double>()[i] = array.at(i);
  const bool is_whole =
      array.type[0] != 'f' ||
      (any_whole_number && std::all_of(values.begin<double>(), values.end<double>(),
                                       [](double v) { return v == std::floor(v); }));
  double min = 0.0, max = 0.0;
  cv::minMaxLoc(values, &min, &max);
  if (is_whole && (min < 0.0 || max > 65535.0))
    throw std::runtime_error(fmt::format("counts from {} to {} instead of 0 to 65535", min, max));
  values.convertTo(depth, is_whole ? CV_16U : CV_32F);
  return depth;
}

}  // namespace touchtrace
