#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/import/gloves/glove_columns.h"
#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/acquire/import/gloves/glove_values.h"
#include "pipeline/acquire/import/gloves/numbered_columns.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_frames = 10'000'000;

/// Stamp of the current row. Text must be a date and a time.
double stamp_of(const TextTable& table, const TableColumn& time, bool& has_dates) {
  if (const auto date_s = date_of(table, time)) {
    has_dates = true;
    return *date_s;
  }
  const double stamp = value_of<double>(table, time);
  if (std::isnan(stamp)) throw LineFault{"the time is missing"};
  return stamp;
}

/// Number in the current row; 0 for text, which then does not count frames.
double number_of(const TextTable& table, const TableColumn& column) {
  constexpr double max_number = 9e15;
  const auto number = parse_number<double>(table.fields()[column.index], table.has_decimal_comma());
  return number && *number >= 0.0 && *number <= max_number ? *number : 0.0;
}

/// Frames of a table, row by row.
class FrameReader {
 public:
  FrameReader(const TextTable& table, const GloveColumns& columns, double rate_hz)
      : table_(table),
        columns_(columns),
        rate_hz_(rate_hz),
        values_(columns.taxels.size()),
        last_(columns.taxels.size(), -std::numeric_limits<double>::infinity()),
        increases_(columns.taxels.size(), true) {}

  /// Leaves out a row in which a taxel has no value.
  void append_row(GloveFile& glove) {
    const auto row = static_cast<double>(num_rows_++);
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = value_of<double>(table_, columns_.taxels[i]);
    if (std::ranges::any_of(values_, [](double value) { return std::isnan(value); })) {
      ++num_incomplete_;
      return;
    }
    glove.time_s.push_back(columns_.time ? stamp_of(table_, *columns_.time, glove.has_time_unit)
                                         : row / rate_hz_);
    if (columns_.sequence)
      glove.sequence.push_back(static_cast<std::uint64_t>(number_of(table_, *columns_.sequence)));
    if (columns_.epoch) glove.epoch_unix_s = number_of(table_, *columns_.epoch);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      increases_[i] = increases_[i] && values_[i] > last_[i];
      glove.values.push_back(static_cast<float>(values_[i]));
    }
    last_ = values_;
  }

  void report_incomplete() const {
    touchtrace::report_incomplete(table_.file(), num_incomplete_, num_rows_);
  }

  /// Whether the values of a taxel increased in each row, as those of clocks and counters do.
  bool increases(std::size_t taxel) const { return increases_[taxel]; }

 private:
  const TextTable& table_;
  const GloveColumns& columns_;
  double rate_hz_;
  std::vector<double> values_, last_;  ///< [taxels] of this row and of the one before
  std::vector<bool> increases_;
  std::size_t num_rows_ = 0, num_incomplete_ = 0;
};

/// Leaves out clocks and counters, unless the layout needs all columns.
void drop_clocks(const FrameReader& reader, const GloveFileOptions& options, GloveColumns& columns,
                 GloveFile& glove) {
  const std::size_t count = columns.taxels.size();
  const std::size_t needed =
      static_cast<std::size_t>(options.rows) * static_cast<std::size_t>(options.cols);
  if (!options.taxels.empty() || glove.time_s.size() < min_clock_rows || needed == count) return;
  std::vector<TableColumn> taxels;
  for (std::size_t i = 0; i < count; ++i)
    if (!reader.increases(i)) taxels.push_back(columns.taxels[i]);
  if (taxels.size() == count || taxels.empty()) return;
  std::vector<float> values;
  for (std::size_t i = 0; i < glove.values.size(); ++i)
    if (!reader.increases(i % count)) values.push_back(glove.values[i]);
  for (std::size_t i = 0; i < count; ++i)
    if (reader.increases(i))
      Progress::warn(fmt::format("glove: skipped '{}', which increases in each row as clocks do",
                                 columns.taxels[i].label));
  columns.taxels = std::move(taxels), glove.values = std::move(values);
}

void report_columns(const GloveColumns& columns, const GloveFileOptions& options) {
  Progress::report(fmt::format(
      "glove: times are {}; {} taxels from '{}' to '{}'",
      columns.time ? fmt::format("'{}'", columns.time->label)
                   : fmt::format("those of {:g} frames per second", options.rate_hz),
      columns.taxels.size(), columns.taxels.front().label, columns.taxels.back().label));
}

/// Throws data_error if the first column of a table without names counts its rows.
void require_times(const GloveFile& glove, const TextTable& table) {
  if (!table.names().empty() || glove.time_s.size() < 3) return;
  for (std::size_t i = 1; i < glove.time_s.size(); ++i)
    if (glove.time_s[i] - glove.time_s[i - 1] != 1.0) return;
  throw data_error(
      fmt::format("{}: column 1 counts the rows, it is not a time", table.file().string()),
      glove_table_hint);
}

}  // namespace

bool is_glove_table(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return std::ranges::any_of(std::array{".csv", ".txt", ".tsv", ".asc", ".log", ".dat"},
                             [&](const char* other) { return extension == other; });
}

GloveFile read_glove_table(const std::filesystem::path& file, const GloveFileOptions& options) {
  require_no_stream(options);
  TextTable table(file);
  GloveColumns columns = columns_of_glove(table, options);
  const GloveFileOptions layout = with_named_layout(options, columns);
  GloveFile glove;
  glove.has_time_unit = !columns.time || columns.time->has_unit;
  if (!columns.time) glove.counted_rate_hz = options.rate_hz;
  if (columns.taxels.empty()) set_layout(glove, 0, layout);
  FrameReader reader(table, columns, options.rate_hz);
  for_each_row(table, max_frames, glove_table_hint, [&] { reader.append_row(glove); });
  reader.report_incomplete();
  drop_clocks(reader, layout, columns, glove);
  report_columns(columns, options);
  try {
    set_layout(glove, columns.taxels.size(), layout);
  } catch (const Error& error) {
    const bool is_guess = columns.time && table.names().empty();
    throw data_error(
        fmt::format("{}: {}", error.what(), list_of(columns.taxels)),
        fmt::format("{}; or name the columns of the taxels: --taxels FIRST:LAST{}", error.hint(),
                    is_guess ? "; '" + columns.time->label +
                                   "' is taken for the time: without times give --rate HZ"
                             : ""));
  }
  if (columns.time) require_times(glove, table);
  return glove;
}

void require_no_stream(const GloveFileOptions& options) {
  if (!options.stream.empty())
    throw data_error(fmt::format("the file has one glove, without the name '{}'", options.stream),
                     "leave out --glove-stream");
}

void set_layout(GloveFile& glove, std::size_t values, const GloveFileOptions& options) {
  const auto count = static_cast<int>(std::min<std::size_t>(values, INT_MAX));
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(count))));
  glove.rows = options.rows > 0 ? options.rows : options.cols > 0 ? count / options.cols : side;
  glove.cols = options.cols > 0 ? options.cols : options.rows > 0 ? count / options.rows : side;
  if (values > 0 && glove.taxels() == values) return;
  const bool is_guess = options.rows == 0 && options.cols == 0;
  throw data_error(is_guess ? fmt::format("{} values per frame are not a square of taxels", values)
                            : fmt::format("{} values per frame do not fit {} rows and {} columns",
                                          values, glove.rows, glove.cols),
                   fmt::format("give --rows and --cols whose product is {}", values));
}

}  // namespace touchtrace
