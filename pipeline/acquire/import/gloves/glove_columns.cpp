#include "pipeline/acquire/import/gloves/glove_columns.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

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
constexpr std::size_t max_listed_columns = 5;
// Fractions of a column's rows. A stamp of whole seconds is that of up to 100 frames.
constexpr double min_time_rises = 0.01, max_time_falls = 0.05;

/// What the first rows tell of a column.
struct ColumnContent {
  std::size_t text = 0, numbers = 0;  ///< fields that are not empty
  std::size_t rises = 0, falls = 0;   ///< from one number to the next
  double first = 0.0, last = 0.0;     ///< numbers

  bool is_text() const {
    return text > 0 &&
           static_cast<double>(text) >= min_text_share * static_cast<double>(text + numbers);
  }
  bool is_clock() const { return text == 0 && numbers >= min_clock_rows && rises + 1 == numbers; }
  /// Times may be texts, repeat themselves and now and then jump back.
  bool may_be_time() const {
    return static_cast<double>(rises) >= min_time_rises * static_cast<double>(numbers) - 1.0 &&
           static_cast<double>(falls) <= max_time_falls * static_cast<double>(numbers);
  }
  void add(double number) {
    if (numbers++ == 0)
      first = number;
    else if (number != last)
      ++(number > last ? rises : falls);
    last = number;
  }
};

/// Whether a column has neither taxels nor times: numbers of frames, time as text, labels.
bool is_other(const std::string& name, const ColumnContent& content) {
  static const std::vector<std::string> others{
      "time_str", "datetime", "date_time", "date",  "frame", "frame_id",  "frame_index", "sequence",
      "packet",   "clip",     "",          "label", "class", "unnamed_0", epoch_name};
  const bool is_counter = name == "index" && content.may_be_time();  // else that of a finger
  return is_counter || std::ranges::find(others, name) != others.end();
}

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

std::string label_of(const TextTable& table, std::size_t column) {
  return table.names().empty() ? fmt::format("column {}", column + 1) : table.names()[column];
}

/// Columns that the user chose for taxels: first, and one behind the last.
using ColumnRange = std::pair<std::size_t, std::size_t>;

/// The first column of times from 2001 to 2100 outside `taxels`, in a unit that their size tells.
std::optional<TableColumn> find_unix_time(const TextTable& table,
                                          const std::vector<ColumnContent>& contents,
                                          const ColumnRange& taxels) {
  constexpr double min_unix_s = 1e9, max_unix_s = 4.1e9;
  for (std::size_t i = 0; i < contents.size(); ++i)
    for (const auto& [suffix, per_unit] : time_units())
      if ((i < taxels.first || i >= taxels.second) && contents[i].is_clock() &&
          contents[i].first >= min_unix_s * per_unit && contents[i].last <= max_unix_s * per_unit)
        return TableColumn{i, per_unit, label_of(table, i), true};
  return std::nullopt;
}

/// Time of a table without names.
std::optional<TableColumn> time_without_name(const TextTable& table,
                                             const std::vector<ColumnContent>& contents,
                                             const GloveFileOptions& options,
                                             const ColumnRange& taxels) {
  if (options.rate_hz > 0.0 && (is_layout(table.num_columns(), options) || !contents[0].is_clock()))
    return std::nullopt;
  if (auto unix_time = find_unix_time(table, contents, taxels)) return unix_time;
  const bool is_taxel = taxels.first == 0 && taxels.second > 0;
  if (!is_taxel && contents[0].may_be_time()) return TableColumn{0, 1.0, "column 1"};
  if (options.rate_hz > 0.0) return std::nullopt;
  throw data_error(
      fmt::format("{} has no times: column 1 {}", table.file().string(),
                  is_taxel ? "has a taxel" : "falls or hardly changes from row to row"),
      "give --rate HZ, or put the times into the first column");
}

std::optional<TableColumn> time_column_of(const TextTable& table,
                                          const std::vector<ColumnContent>& contents,
                                          const GloveFileOptions& options,
                                          const ColumnRange& taxels) {
  if (table.names().empty()) return time_without_name(table, contents, options, taxels);
  // Of columns with several of these names the first kind is taken.
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"time", "t", "timestamp", "time_stamp", "host_time", "ts"},
        {"unix_time"},
        {"datetime", "date_time"},
        {"elapsed", "elapsed_time", "measurement_time", "seconds"}})
    if (auto time = find_column(table, table.names(), names, time_units())) return time;
  if (options.rate_hz > 0.0) return std::nullopt;
  if (auto unix_time = find_unix_time(table, contents, taxels)) return unix_time;
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
                                          const std::vector<ColumnContent>& contents,
                                          const std::optional<TableColumn>& time) {
  const auto& names = table.names();
  const bool has_counts = std::ranges::any_of(
      names, [](const std::string& name) { return name.starts_with("counts_"); });
  std::vector<TableColumn> taxels;
  for (std::size_t i = 0; i < table.num_columns(); ++i) {
    const std::string name = label_of(table, i);
    if ((time && i == time->index) || (!names.empty() && is_other(name, contents[i]))) continue;
    if (!has_counts || name.starts_with("counts_")) taxels.push_back({i, 1.0, name});
  }
  return taxels;
}

/// Leaves out columns of text, unless there are no others.
void drop_text(const std::vector<ColumnContent>& contents, std::vector<TableColumn>& taxels) {
  const auto is_text = [&](const TableColumn& column) { return contents[column.index].is_text(); };
  if (std::ranges::all_of(taxels, is_text)) return;
  std::vector<std::string> skipped;
  for (const TableColumn& column : taxels)
    if (is_text(column)) skipped.push_back("'" + column.label + "'");
  std::erase_if(taxels, is_text);
  if (skipped.size() > max_listed_columns)
    Progress::warn(fmt::format("glove: skipped {} columns of text, from {} to {}", skipped.size(),
                               skipped.front(), skipped.back()));
  else if (!skipped.empty())
    Progress::warn(fmt::format("glove: skipped {}: text", fmt::join(skipped, ", ")));
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

/// Range of the columns that the user chose; empty: none.
ColumnRange chosen_range(const TextTable& table, const std::string& range) {
  if (range.empty()) return {0, 0};
  const auto colon = range.find(':');
  if (colon == std::string::npos)
    throw usage_error(fmt::format("--taxels {} is not FIRST:LAST", range),
                      "name the first and the last column, e.g. --taxels s_0:s_255");
  const std::size_t first = index_of(table, range.substr(0, colon)),
                    last = index_of(table, range.substr(colon + 1));
  if (first > last)
    throw usage_error(fmt::format("--taxels {}: the first column is after the last", range),
                      "exchange them");
  return {first, last + 1};
}

std::vector<TableColumn> columns_in(const TextTable& table, const ColumnRange& range) {
  std::vector<TableColumn> columns;
  for (std::size_t i = range.first; i < range.second; ++i)
    columns.push_back({i, 1.0, label_of(table, i)});
  return columns;
}

}  // namespace

GloveColumns columns_of_glove(TextTable& table, const GloveFileOptions& options) {
  const auto contents = read_contents(table);
  const ColumnRange chosen = chosen_range(table, options.taxels);
  GloveColumns columns{time_column_of(table, contents, options, chosen),
                       column_named(table, "sequence"),
                       column_named(table, epoch_name),
                       {}};
  auto taxels = options.taxels.empty() ? taxel_columns_of(table, contents, columns.time)
                                       : columns_in(table, chosen);
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
