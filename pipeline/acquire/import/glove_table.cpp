#include <fmt/core.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>

#include "engine/base/error.h"
#include "pipeline/acquire/import/glove_file.h"
#include "pipeline/acquire/import/image_times.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_frames = 10'000'000;
constexpr const char* hint = "a row has a time and a value for each taxel, as in 'time_s,0_0,0_1'";

struct TaxelColumns {
  TableColumn time;
  std::vector<TableColumn> taxels;
};

/// Whether a column has neither taxels nor times: numbers of frames, and time as text.
bool is_other(const std::string& name) {
  static const std::vector<std::string> others{"time_str", "datetime", "date",     "frame",
                                               "frame_id", "index",    "sequence", "packet",
                                               "clip",     "",         "unnamed_0"};
  return std::ranges::find(others, name) != others.end();
}

/// Columns of taxels: those named counts_..., as `export` writes them, else all others.
TaxelColumns columns_of_glove(const TextTable& table) {
  const auto& names = table.names();
  TaxelColumns columns{{0, 1.0, "time"}, {}};
  if (!names.empty()) {
    const auto time =
        find_column(table, names, {"time", "t", "timestamp", "host_time", "ts"}, time_units());
    if (!time)
      throw data_error(fmt::format("{} has no column time_s", table.file().string()), hint);
    columns.time = *time;
  }
  const bool has_counts = std::ranges::any_of(
      names, [](const std::string& name) { return name.starts_with("counts_"); });
  for (std::size_t i = 0; i < table.num_columns(); ++i) {
    const std::string name = names.empty() ? fmt::format("column {}", i + 1) : names[i];
    if (i == columns.time.index || (!names.empty() && is_other(name))) continue;
    if (has_counts && !name.starts_with("counts_")) continue;
    columns.taxels.push_back({i, 1.0, name});
  }
  return columns;
}

/// Options with the layout of columns counts_ROW_COL, the last of which has the largest indices.
GloveFileOptions with_named_layout(GloveFileOptions options, const TaxelColumns& columns) {
  int row = 0, col = 0;
  if (options.rows > 0 || options.cols > 0 || columns.taxels.empty() ||
      std::sscanf(columns.taxels.back().label.c_str(), "counts_%4d_%4d", &row, &col) != 2)
    return options;
  options.rows = row + 1, options.cols = col + 1;
  return options;
}

void append_row(const TextTable& table, const TaxelColumns& columns, GloveFile& glove) {
  const double time_s = value_of<double>(table, columns.time);
  if (!(time_s >= 0.0)) throw LineFault{"the time is missing or negative"};
  glove.time_s.push_back(stamp_seconds(time_s));
  for (const TableColumn& taxel : columns.taxels)
    glove.values.push_back(static_cast<float>(value_of<double>(table, taxel)));
}

}  // namespace

bool is_glove_table(const std::filesystem::path& file) {
  return file.extension() == ".csv" || file.extension() == ".txt" || file.extension() == ".tsv";
}

GloveFile read_glove_table(const std::filesystem::path& file, const GloveFileOptions& options) {
  TextTable table(file);
  const TaxelColumns columns = columns_of_glove(table);
  GloveFile glove;
  set_layout(glove, columns.taxels.size(), with_named_layout(options, columns));
  for_each_row(table, max_frames, hint, [&] { append_row(table, columns, glove); });
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
                     "give --rows and --cols");
}

}  // namespace touchtrace
