#include "pipeline/acquire/import/gloves/glove_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/gloves/taxel_names.h"

namespace touchtrace {
namespace {

constexpr const char* epoch_name = "epoch_unix_s";
constexpr std::size_t max_counted_rows = 1000;
constexpr double min_text_share = 0.9;

/// Whether a column has neither taxels nor times: numbers of frames, time as text, labels.
bool is_other(const std::string& name) {
  static const std::vector<std::string> others{
      "time_str", "datetime", "date", "frame",     "frame_id", "frame_index", "index",   "sequence",
      "packet",   "clip",     "",     "unnamed_0", "label",    "class",       epoch_name};
  return std::ranges::find(others, name) != others.end();
}

/// Whether as many values are a frame.
bool is_layout(std::size_t values, const GloveFileOptions& options) {
  const auto rows = static_cast<std::size_t>(options.rows),
             cols = static_cast<std::size_t>(options.cols),
             side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(values))));
  if (rows > 0 && cols > 0) return values == rows * cols;
  return rows + cols > 0 ? values % (rows + cols) == 0 : values == side * side;
}

std::optional<TableColumn> time_column_of(const TextTable& table, const GloveFileOptions& options) {
  const double rate_hz = options.rate_hz;
  if (table.names().empty()) {
    if (rate_hz > 0.0 && is_layout(table.num_columns(), options)) return std::nullopt;
    return TableColumn{0, 1.0, "column 1"};
  }
  const auto time = find_column(table, table.names(), {"time", "t", "timestamp", "host_time", "ts"},
                                time_units());
  if (!time && rate_hz == 0.0)
    throw data_error(fmt::format("{} has no column time_s", table.file().string()),
                     std::string(glove_table_hint) + "; without times give --rate HZ");
  return time;
}

std::optional<TableColumn> column_named(const TextTable& table, const char* name) {
  const auto found = std::ranges::find(table.names(), name);
  if (found == table.names().end()) return std::nullopt;
  return TableColumn{static_cast<std::size_t>(found - table.names().begin()), 1.0, name};
}

/// Columns of taxels in the order of the file: those named counts_..., as `export` writes them,
/// else all others.
std::vector<TableColumn> taxel_columns_of(const TextTable& table,
                                          const std::optional<TableColumn>& time) {
  const auto& names = table.names();
  const bool has_counts = std::ranges::any_of(
      names, [](const std::string& name) { return name.starts_with("counts_"); });
  std::vector<TableColumn> taxels;
  for (std::size_t i = 0; i < table.num_columns(); ++i) {
    const std::string name = names.empty() ? fmt::format("column {}", i + 1) : names[i];
    if ((time && i == time->index) || (!names.empty() && is_other(name))) continue;
    if (!has_counts || name.starts_with("counts_")) taxels.push_back({i, 1.0, name});
  }
  return taxels;
}

/// Fields of a column that are not empty.
struct FieldCount {
  std::size_t text = 0, numbers = 0;
  bool is_text() const {
    return text > 0 &&
           static_cast<double>(text) >= min_text_share * static_cast<double>(text + numbers);
  }
};

std::vector<FieldCount> count_fields(TextTable& table) {
  std::vector<FieldCount> counts(table.num_columns());
  for (std::size_t row = 0; row < max_counted_rows && table.next_row(); ++row)
    for (std::size_t i = 0; i < std::min(counts.size(), table.fields().size()); ++i) {
      const auto number = parse_number<double>(table.fields()[i], table.has_decimal_comma());
      if (!number)
        ++counts[i].text;
      else if (!std::isnan(*number))
        ++counts[i].numbers;
    }
  table.rewind();
  return counts;
}

/// Leaves out columns of text, unless there are no others.
void drop_text(TextTable& table, std::vector<TableColumn>& taxels) {
  const auto counts = count_fields(table);
  const auto is_text = [&](const TableColumn& column) { return counts[column.index].is_text(); };
  if (std::ranges::all_of(taxels, is_text)) return;
  for (const TableColumn& column : taxels)
    if (is_text(column))
      Progress::warn(fmt::format("glove: skipped '{}', which is text", column.label));
  std::erase_if(taxels, is_text);
}

}  // namespace

GloveColumns columns_of_glove(TextTable& table, const GloveFileOptions& options) {
  GloveColumns columns{time_column_of(table, options),
                       column_named(table, "sequence"),
                       column_named(table, epoch_name),
                       {}};
  auto taxels = taxel_columns_of(table, columns.time);
  drop_text(table, taxels);
  std::vector<std::string> names;
  for (const TableColumn& taxel : taxels) names.push_back(taxel.label);
  const NamedLayout layout = named_layout(names, table.file());
  for (const std::size_t i : layout.column) columns.taxels.push_back(taxels[i]);
  columns.rows = layout.rows, columns.cols = layout.cols;
  return columns;
}

GloveFileOptions with_named_layout(GloveFileOptions options, const GloveColumns& columns) {
  if (columns.rows == 0) return options;
  if ((options.rows > 0 && options.rows != columns.rows) ||
      (options.cols > 0 && options.cols != columns.cols))
    throw data_error(fmt::format("the columns are named for {} x {} taxels, not {} x {}",
                                 columns.rows, columns.cols, options.rows, options.cols),
                     "leave out --rows and --cols");
  options.rows = columns.rows, options.cols = columns.cols;
  return options;
}

}  // namespace touchtrace
