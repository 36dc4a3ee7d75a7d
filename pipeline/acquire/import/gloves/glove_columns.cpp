#include "pipeline/acquire/import/gloves/glove_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/import/gloves/numbered_columns.h"
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

/// What the first rows tell of a column.
struct ColumnContent {
  std::size_t text = 0, numbers = 0;  ///< fields that are not empty
  double first = 0.0, last = 0.0;     ///< numbers
  bool increases = true;              ///< in each row

  bool is_text() const {
    return text > 0 &&
           static_cast<double>(text) >= min_text_share * static_cast<double>(text + numbers);
  }
  bool is_clock() const { return text == 0 && numbers >= min_clock_rows && increases; }
  void add(double number) {
    increases = increases && (numbers == 0 || number > last);
    if (numbers++ == 0) first = number;
    last = number;
  }
};

std::vector<ColumnContent> read_contents(TextTable& table) {
  std::vector<ColumnContent> contents(table.num_columns());
  for (std::size_t row = 0; row < max_counted_rows && table.next_row(); ++row)
    for (std::size_t i = 0; i < std::min(contents.size(), table.fields().size()); ++i) {
      const auto number = parse_number<double>(table.fields()[i], table.has_decimal_comma());
      if (!number)
        ++contents[i].text;
      else if (!std::isnan(*number))
        contents[i].add(*number);
    }
  table.rewind();
  return contents;
}

/// The first column of times from 2001 to 2100, in a unit that their size tells.
std::optional<TableColumn> find_unix_time(const TextTable& table,
                                          const std::vector<ColumnContent>& contents) {
  constexpr double min_unix_s = 1e9, max_unix_s = 4.1e9;
  for (std::size_t i = 0; i < contents.size(); ++i)
    for (const auto& [suffix, per_unit] : time_units())
      if (contents[i].is_clock() && contents[i].first >= min_unix_s * per_unit &&
          contents[i].last <= max_unix_s * per_unit)
        return TableColumn{i, per_unit, table.names()[i], true};
  return std::nullopt;
}

std::optional<TableColumn> time_column_of(const TextTable& table,
                                          const std::vector<ColumnContent>& contents,
                                          const GloveFileOptions& options) {
  const double rate_hz = options.rate_hz;
  if (table.names().empty()) {
    if (rate_hz > 0.0 && (is_layout(table.num_columns(), options) || !contents[0].is_clock()))
      return std::nullopt;
    return TableColumn{0, 1.0, "column 1"};
  }
  const auto time = find_column(table, table.names(), {"time", "t", "timestamp", "host_time", "ts"},
                                time_units());
  if (time || rate_hz > 0.0) return time;
  if (auto unix_time = find_unix_time(table, contents)) return unix_time;
  throw data_error(fmt::format("{} has no column time_s", table.file().string()),
                   std::string(glove_table_hint) +
                       "; rename the column of times, or without times give --rate HZ");
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

/// Leaves out columns of text, unless there are no others.
void drop_text(const std::vector<ColumnContent>& contents, std::vector<TableColumn>& taxels) {
  const auto is_text = [&](const TableColumn& column) { return contents[column.index].is_text(); };
  if (std::ranges::all_of(taxels, is_text)) return;
  for (const TableColumn& column : taxels)
    if (is_text(column))
      Progress::warn(fmt::format("glove: skipped '{}', which is text", column.label));
  std::erase_if(taxels, is_text);
}

/// Index of a column by its name or its number from 1.
std::size_t index_of(const TextTable& table, const std::string& text) {
  const auto& names = table.names();
  const auto found = std::ranges::find(names, column_name(text));
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::size_t number = 0;
  if (parse_whole(text, number) && number >= 1 && number <= table.num_columns()) return number - 1;
  throw data_error(
      fmt::format("{} has no column '{}'", table.file().string(), text),
      fmt::format("give numbers from 1 to {}{}", table.num_columns(),
                  names.empty() ? "" : "; or " + suggestion(column_name(text), names)));
}

/// The columns that the user chose.
std::vector<TableColumn> chosen_columns(const TextTable& table, const std::string& range) {
  const auto colon = range.find(':');
  if (colon == std::string::npos)
    throw usage_error(fmt::format("--taxels {} is not FIRST:LAST", range),
                      "name the first and the last column, e.g. --taxels s_0:s_255");
  const std::size_t first = index_of(table, range.substr(0, colon)),
                    last = index_of(table, range.substr(colon + 1));
  if (first > last)
    throw usage_error(fmt::format("--taxels {}: the first column is after the last", range),
                      "exchange them");
  std::vector<TableColumn> columns;
  for (std::size_t i = first; i <= last; ++i)
    columns.push_back(
        {i, 1.0, table.names().empty() ? fmt::format("column {}", i + 1) : table.names()[i]});
  return columns;
}

}  // namespace

GloveColumns columns_of_glove(TextTable& table, const GloveFileOptions& options) {
  const auto contents = read_contents(table);
  GloveColumns columns{time_column_of(table, contents, options),
                       column_named(table, "sequence"),
                       column_named(table, epoch_name),
                       {}};
  auto taxels = options.taxels.empty() ? taxel_columns_of(table, columns.time)
                                       : chosen_columns(table, options.taxels);
  if (options.taxels.empty()) {
    drop_text(contents, taxels);
    keep_numbered(options, taxels);
  }
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
