#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "engine/base/csv_field.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/interrupt.h"
#include "pipeline/export/tables.h"

namespace touchtrace {
namespace {

constexpr std::size_t flush_bytes = 1u << 20;

/// Path of a table: OUT.csv, OUT.clips.csv.
std::filesystem::path csv_path(const std::filesystem::path& output, const std::string& table) {
  if (table.empty()) return output;
  auto path = output;
  return path.replace_filename(output.stem().string() + "." + table + output.extension().string());
}

/// "counts_3_14", "hand_covariance_x_vx".
void append_names(std::string& header, const std::string& name, std::span<const AxisNames> axes) {
  if (axes.empty()) {
    if (!header.empty()) header += ',';
    header += name;
    return;
  }
  for (const auto& index : axes[0]) append_names(header, name + "_" + index, axes.subspan(1));
}

/// Numbers as the shortest text that gives the same value; text in quotes where it needs them.
template <class Value>
void append_value(std::string& text, const Value& value) {
  if constexpr (std::is_same_v<Value, std::string>) {
    text += csv_field(value);
  } else {
    fmt::format_to(std::back_inserter(text), "{}", value);
  }
}

void append_row(std::string& text, const DataTable& table, std::size_t row) {
  const char* separator = "";
  for (const TableArray& array : table.arrays)
    std::visit(
        [&](const auto& values) {
          const std::size_t count = array.row_values();
          for (std::size_t i = row * count; i < (row + 1) * count; ++i) {
            text += separator;
            append_value(text, values[i]);
            separator = ",";
          }
        },
        array.values);
  text += '\n';
}

void write_table(const std::filesystem::path& path, const DataTable& table) {
  std::ofstream stream(path, std::ios::binary);
  std::string text;
  for (const TableArray& array : table.arrays) append_names(text, array.name, array.axes);
  text += '\n';
  for (std::size_t row = 0; row < table.rows; ++row) {
    append_row(text, table, row);
    if (text.size() < flush_bytes) continue;
    throw_if_interrupted();
    stream << text;
    text.clear();
  }
  stream << text << std::flush;
  if (!stream)
    throw failure(fmt::format("cannot write {}", path.string()),
                  "check free disk space and write permission");
}

}  // namespace

std::vector<std::filesystem::path> write_csv(const ExportRequest& request) {
  const auto tables = read_tables(request);
  std::vector<std::unique_ptr<OutputFile>> files;
  for (const DataTable& table : tables)
    files.push_back(
        std::make_unique<OutputFile>(csv_path(request.output, table.name), request.overwrite));
  std::vector<std::filesystem::path> paths;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    write_table(files[i]->temporary(), tables[i]);
    files[i]->commit();
    paths.push_back(files[i]->path());
  }
  return paths;
}

}  // namespace touchtrace
