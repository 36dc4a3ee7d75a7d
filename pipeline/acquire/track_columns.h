#pragma once

#include <array>
#include <optional>

#include "pipeline/acquire/table_columns.h"

namespace touchtrace {

/// Columns of a table with measured positions.
struct TrackColumns {
  TableColumn time;
  std::array<TableColumn, 3> position;
  std::optional<std::array<TableColumn, 3>> sigma;  ///< standard deviations
};

/// Finds the columns by the names of the header, or of a comment before the first row, or by their
/// number. Throws data_error if there are none, or several, for a quantity.
TrackColumns columns_of(const TextTable& table);

}  // namespace touchtrace
