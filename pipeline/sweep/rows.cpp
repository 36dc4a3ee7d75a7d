#include "pipeline/sweep/rows.h"

#include <algorithm>
#include <set>

#include "engine/base/csv_field.h"
#include "engine/base/json_text.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::ordered_json;

/// Differ from run to run.
const std::set<std::string> costs{"wall_seconds", "cpu_seconds"};

ordered_json scalars(const ordered_json& object) {
  auto fields = ordered_json::object();
  if (object.is_object())
    for (const auto& [name, value] : object.items())
      if (value.is_primitive() && !costs.contains(name)) fields[name] = value;
  return fields;
}

/// Adds an axis; one whose name has another value already is called "`prefix`.NAME".
void add_axis(Row& row, const std::string& prefix, const std::string& name,
              const ordered_json& value) {
  for (const ordered_json* known : {&row.axes, &row.fields})
    if (const auto found = known->find(name); found != known->end() && *found != value) {
      row.axes[prefix + "." + name] = value;
      return;
    }
  row.axes[name] = value;
  row.fields.erase(name);
}

Row row_of(const ordered_json& axes, const ordered_json& result) {
  Row row{ordered_json::object(), scalars(result)};
  for (const auto& [name, value] : axes.items()) add_axis(row, "axis", name, value);
  if (!result.is_object()) return row;
  const auto options = scalars(result.value("options", ordered_json()));
  for (const auto& [name, value] : options.items()) add_axis(row, "option", name, value);
  return row;
}

bool has_results(const FinishedCell& cell) {
  return cell.result.is_object() && cell.result.contains("results") &&
         cell.result["results"].is_array();
}

std::string line_of(const std::vector<std::string>& texts) {
  std::string line;
  for (const auto& text : texts) line += (&text == texts.data() ? "" : ",") + csv_field(text);
  return line + "\n";
}

}  // namespace

std::vector<Row> rows_of(const std::vector<FinishedCell>& cells) {
  std::vector<Row> rows;
  const bool listed = std::ranges::any_of(cells, has_results);
  for (const FinishedCell& cell : cells)
    if (!listed && cell.stage == cells.back().stage)
      rows.push_back(row_of(cell.axes, cell.result));
    else if (has_results(cell))
      for (const auto& result : cell.result["results"]) rows.push_back(row_of(cell.axes, result));
  return rows;
}

bool is_seed(const std::string& axis) { return axis == "seed" || axis.ends_with(".seed"); }

std::vector<std::string> columns_of(const std::vector<Row>& rows) {
  std::vector<std::string> columns;
  for (const auto part : {&Row::axes, &Row::fields})
    for (const Row& row : rows)
      for (const auto& entry : (row.*part).items())
        if (std::ranges::find(columns, entry.key()) == columns.end())
          columns.push_back(entry.key());
  return columns;
}

std::string text_of(const ordered_json& value) {
  if (value.is_null()) return "";
  return json_text(value);
}

std::string csv_of(const std::vector<Row>& rows) {
  const auto columns = columns_of(rows);
  std::string text = line_of(columns);
  for (const Row& row : rows) {
    std::vector<std::string> texts;
    for (const auto& column : columns)
      texts.push_back(text_of(
          row.axes.contains(column) ? row.axes[column] : row.fields.value(column, ordered_json())));
    text += line_of(texts);
  }
  return text;
}

}  // namespace touchtrace::sweep
