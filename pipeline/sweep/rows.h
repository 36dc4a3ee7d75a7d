#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/sweep/manifest.h"

namespace touchtrace::sweep {

/// One result with the axis values of its cell.
struct Row {
  nlohmann::ordered_json axes, fields;  ///< objects of numbers, texts and booleans
};

/// Rows of all cells: the entries of "results" of a cell's result. If no cell has "results", the
/// scalar members of the last stage's results. wall_seconds and cpu_seconds, which differ from run
/// to run, are skipped. Members of a result's "options" become axes. An axis whose name is a field
/// of another value is called "axis.NAME", an option "option.NAME".
std::vector<Row> rows_of(const std::vector<FinishedCell>& cells);

/// Whether an axis repeats the same experiment: "seed", or "STAGE.seed".
bool is_seed(const std::string& axis);

/// Axes, then fields, in the order of their first appearance.
std::vector<std::string> columns_of(const std::vector<Row>& rows);

/// Comma-separated values with a header.
std::string csv_of(const std::vector<Row>& rows);

/// Text of a scalar: strings without quotes, null as nothing.
std::string text_of(const nlohmann::ordered_json& value);

}  // namespace touchtrace::sweep
