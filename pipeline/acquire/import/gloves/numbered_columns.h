#pragma once

#include <string>
#include <vector>

#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {

/// Whether so many values per frame have the layout of the options, or are a square without one.
bool is_layout(std::size_t values, const GloveFileOptions& options);

/// Names of the columns for a message: "s_0 to s_255, x, y".
std::string list_of(const std::vector<TableColumn>& columns);

/// Keeps one run of columns whose names count from one to the next, or all such runs, with a
/// warning, if that fits the layout and all columns do not. Without a layout 16 columns or more are
/// needed.
void keep_numbered(const GloveFileOptions& options, std::vector<TableColumn>& taxels);

}  // namespace touchtrace
