#include <fmt/format.h>

#include "engine/base/files.h"
#include "pipeline/export/tables.h"
#include "pipeline/export/zip_writer.h"

namespace touchtrace {
namespace {

constexpr std::size_t header_alignment = 64;

/// Type as NumPy writes it, such as "<f8"; and the bytes of the values.
struct NumpyValues {
  std::string type, bytes;
};

/// Text becomes bytes of the longest one's length, padded with zeros.
NumpyValues numpy_values(const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const auto& text : texts) longest = std::max(longest, text.size());
  NumpyValues values{fmt::format("|S{}", longest), {}};
  for (const auto& text : texts) values.bytes += text + std::string(longest - text.size(), '\0');
  return values;
}

template <class Number>
NumpyValues numpy_values(const std::vector<Number>& numbers) {
  const char letter = std::is_floating_point_v<Number> ? 'f' : std::is_signed_v<Number> ? 'i' : 'u';
  return {fmt::format("{}{}{}", sizeof(Number) == 1 ? '|' : '<', letter, sizeof(Number)),
          {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)}};
}

/// Array in the .npy format, version 1.0 (numpy.lib.format).
std::string npy_file(const TableArray& array, std::size_t rows) {
  const NumpyValues values =
      std::visit([](const auto& v) { return numpy_values(v); }, array.values);
  std::string shape = fmt::format("{},", rows);
  for (const AxisNames& axis : array.axes) shape += fmt::format(" {},", axis.size());
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", values.type, shape);
  constexpr std::size_t prefix_bytes = 10;
  header.append(header_alignment - 1 - (prefix_bytes + header.size()) % header_alignment, ' ');
  header += '\n';
  const auto length = static_cast<std::uint16_t>(header.size());
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(length & 0xff);
  file += static_cast<char>(length >> 8);
  return file + header + values.bytes;
}

}  // namespace

std::vector<std::filesystem::path> write_npz(const ExportRequest& request) {
  const auto tables = read_tables(request);
  OutputFile output(request.output, request.overwrite);
  ZipWriter zip(output.temporary());
  for (const DataTable& table : tables)
    for (const TableArray& array : table.arrays)
      zip.add((table.name.empty() ? "" : table.name + "_") + array.name + ".npy",
              npy_file(array, table.rows));
  zip.finish();
  output.commit();
  return {request.output};
}

}  // namespace touchtrace
