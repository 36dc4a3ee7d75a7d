#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/export/export.h"

namespace touchtrace {

using ColumnValues =
    std::variant<std::vector<double>, std::vector<float>, std::vector<std::uint64_t>,
                 std::vector<std::int64_t>, std::vector<std::int32_t>, std::vector<std::uint16_t>,
                 std::vector<std::uint8_t>, std::vector<std::string>>;

/// Names of the indices along one axis, such as x, y, z.
using AxisNames = std::vector<std::string>;

/// Array [rows, axes...] of a table, row-major.
struct TableArray {
  std::string name;  ///< with the unit: "hand_position_m"
  ColumnValues values;
  std::vector<AxisNames> axes = {};  ///< of the axes after the first

  std::size_t row_values() const;  ///< number of values of a row
};

/// Arrays with the same number of rows.
struct DataTable {
  std::string name;  ///< empty for the main table of a file
  std::vector<TableArray> arrays;
  std::size_t rows = 0;
};

/// Contents of a labels file, of the gloves of a recording, or of predictions; the main table comes
/// first. Throws data_error, also for a recording without a glove.
std::vector<DataTable> read_tables(const ExportRequest& request);

}  // namespace touchtrace
