#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/acquire/table_units.h"
#include "pipeline/acquire/text_table.h"

namespace touchtrace {

/// Column of a table of numbers.
struct TableColumn {
  std::size_t index;
  double per_unit = 1.0;  ///< the column's values divided by it are in seconds or metres
  std::string label;      ///< for messages
  bool has_unit = false;  ///< its name has one
};

/// Column of `columns` whose name is one of `names`, with or without a unit. Returns nullopt if
/// there is none. Throws data_error if there are several.
std::optional<TableColumn> find_column(const TextTable& table,
                                       const std::vector<std::string>& columns,
                                       const std::vector<std::string>& names,
                                       std::span<const TableUnit> units);

/// Fault of one line of a table, thrown by value_of().
struct LineFault {
  std::string text;
};

/// Value in the current row, in seconds or metres; NaN if it is missing. Throws LineFault for text
/// and for infinite values. `Number`: double or long double.
template <class Number>
Number value_of(const TextTable& table, const TableColumn& column);

/// Unix time of a date in the current row (ISO 8601); nullopt for a number or other text.
std::optional<double> date_of(const TextTable& table, const TableColumn& column);

/// Calls `add_row` for each row of the table. Throws data_error with the first few faults of all
/// rows: each LineFault that `add_row` throws, and rows of another length than the first. Leaves
/// out a last row that was cut off, with a warning. Throws data_error for more than `max_rows`.
void for_each_row(TextTable& table, std::size_t max_rows, const std::string& hint,
                  const std::function<void()>& add_row);

}  // namespace touchtrace
