#include <fmt/core.h>

#include <algorithm>
#include <climits>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/acquire/import/glove_columns.h"
#include "pipeline/acquire/import/glove_file.h"
#include "pipeline/acquire/import/iso_time.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_frames = 10'000'000;

/// Stamp of the current row. Text must be a date and a time.
double stamp_of(const TextTable& table, const TableColumn& time, bool& has_dates) {
  const auto field = table.fields()[time.index];
  if (!parse_number<double>(field, table.has_decimal_comma()))
    if (const auto date_s = parse_iso_time(field)) {
      has_dates = true;
      return *date_s;
    }
  const double stamp = value_of<double>(table, time);
  if (!(stamp >= 0.0)) throw LineFault{"the time is missing or negative"};
  return stamp;
}

/// Frame number of the current row; 0 for text, which then does not count frames.
std::uint64_t number_of(const TextTable& table, const TableColumn& sequence) {
  constexpr double max_number = 9e15;
  const auto number =
      parse_number<double>(table.fields()[sequence.index], table.has_decimal_comma());
  return number && *number >= 0.0 && *number <= max_number ? static_cast<std::uint64_t>(*number)
                                                           : 0;
}

void append_row(const TextTable& table, const GloveColumns& columns, GloveFile& glove) {
  glove.time_s.push_back(stamp_of(table, columns.time, glove.has_time_unit));
  if (columns.sequence) glove.sequence.push_back(number_of(table, *columns.sequence));
  for (const TableColumn& taxel : columns.taxels)
    glove.values.push_back(static_cast<float>(value_of<double>(table, taxel)));
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
  return file.extension() == ".csv" || file.extension() == ".txt" || file.extension() == ".tsv";
}

GloveFile read_glove_table(const std::filesystem::path& file, const GloveFileOptions& options) {
  TextTable table(file);
  const GloveColumns columns = columns_of_glove(table);
  GloveFile glove;
  glove.has_time_unit = columns.time.per_unit != 1.0;
  set_layout(glove, columns.taxels.size(), with_named_layout(options, columns));
  for_each_row(table, max_frames, glove_table_hint, [&] { append_row(table, columns, glove); });
  require_times(glove, table);
  return glove;
}

void set_layout(GloveFile& glove, std::size_t values, const GloveFileOptions& options) {
  const auto count = static_cast<int>(std::min<std::size_t>(values, INT_MAX));
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(count))));
  glove.rows = options.rows > 0 ? options.rows : options.cols > 0 ? count / options.cols : side;
  glove.cols = options.cols > 0 ? options.cols : options.rows > 0 ? count / options.rows : side;
  if (values == 0 || glove.taxels() != values)
    throw data_error(fmt::format("{} values per frame do not fit {} rows and {} columns", values,
                                 glove.rows, glove.cols),
                     fmt::format("give --rows and --cols whose product is {}", values));
}

}  // namespace touchtrace
