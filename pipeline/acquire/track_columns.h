#pragma once

#include <array>
#include <optional>

#include "pipeline/acquire/table_columns.h"

namespace touchtrace {

/// What a file of positions cannot tell.
struct TrackOptions {
  std::string x_column = {};  ///< of a file with several bodies, e.g. "hand_x"; empty: the only one
  double rate_hz = 0.0;       ///< of a file without times; 0: it has times
};

/// Columns of a table with measured positions.
struct TrackColumns {
  std::optional<TableColumn> time;  ///< nullopt: rows have a rate
  std::array<TableColumn, 3> position;
  std::optional<std::array<TableColumn, 3>> sigma;  ///< standard deviations
};

/// Finds the columns by the names of the header, or of a comment before the first row, or by their
/// number. Positions are x, y, z, else the only three columns whose names differ by these letters,
/// such as hand_x, hand_y, hand_z; quaternions and velocities do not count. Throws data_error if
/// there are none, or several, for a quantity.
TrackColumns columns_of(const TextTable& table, const TrackOptions& options);

}  // namespace touchtrace
