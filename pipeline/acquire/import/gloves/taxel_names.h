#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace touchtrace {

/// Layout of taxels that the names of a table's columns tell.
struct NamedLayout {
  int rows = 0, cols = 0;           ///< 0: the names do not tell
  std::vector<std::size_t> column;  ///< [rows, cols], index in the names; in their order if unknown
};

/// Names ROW_COL or counts_ROW_COL, in any order, counted from 0 or 1. Names that end with one
/// number are put in the order of their numbers, unless a number is repeated. Throws data_error if
/// a taxel is missing or has two columns. `file`: for the message.
NamedLayout named_layout(const std::vector<std::string>& names, const std::filesystem::path& file);

}  // namespace touchtrace
