#pragma once

#include <optional>
#include <vector>

#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {

inline constexpr const char* glove_table_hint =
    "a row has a time and a value for each taxel, as in 'time_s,0_0,0_1'";

/// Columns of a table with the frames of a glove.
struct GloveColumns {
  std::optional<TableColumn> time, sequence, epoch;
  std::vector<TableColumn> taxels;  ///< row by row of the glove
  int rows = 0, cols = 0;           ///< 0: not in the names
};

/// Columns by their names. Leaves out columns of text, with a warning: those whose first 1000 rows
/// have text in 90 % of the fields that are not empty. Without names, the first column is the time
/// unless frames have a rate and all columns fit the layout. Throws data_error if there is no time
/// and no rate.
GloveColumns columns_of_glove(TextTable& table, const GloveFileOptions& options);

/// Options with the layout that the columns' names tell. Throws data_error if they contradict it.
GloveFileOptions with_named_layout(GloveFileOptions options, const GloveColumns& columns);

}  // namespace touchtrace
