#pragma once

#include <optional>
#include <vector>

#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {

inline constexpr const char* glove_table_hint =
    "a row has a time and a value for each taxel, as in 'time_s,0_0,0_1'";

/// Rows in which a column must increase to be taken for a clock or counter.
inline constexpr std::size_t min_clock_rows = 20;

/// Columns of a table with the frames of a glove.
struct GloveColumns {
  std::optional<TableColumn> time, sequence, epoch;
  std::vector<TableColumn> taxels;  ///< row by row of the glove
  int rows = 0, cols = 0;           ///< 0: not in the names
};

/// Columns by their names.
///
/// - Time: by its name; else, if there is no rate, the first column of times since 1970. Without
///   names that, or else the first column, unless frames have a rate and all columns fit the layout
///   or the first one does not always increase. Never a column of the taxels in `options`.
/// - Taxels: those of `options`; else all others but columns of text, which are named in a warning:
///   in the first 1000 rows 90 % of their fields that are not empty are text. If these do not fit
///   the layout, but columns that are numbered one after the other do, only those.
///
/// Throws data_error if there is no time and no rate, the first column without a name cannot be a
/// time, or there is no such column.
GloveColumns columns_of_glove(TextTable& table, const GloveFileOptions& options);

/// Options with the layout that the columns' names tell. Throws data_error if they contradict it.
GloveFileOptions with_named_layout(GloveFileOptions options, const GloveColumns& columns);

}  // namespace touchtrace
