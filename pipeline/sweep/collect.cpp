#include "pipeline/sweep/collect.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/files.h"
#include "pipeline/sweep/event_file.h"
#include "pipeline/sweep/rows.h"
#include "pipeline/sweep/summary_table.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

/// "throw,full,1": name of a curve in TensorBoard.
std::string run_name(const ordered_json& axes) {
  std::string name;
  for (const auto& value : axes) name += (name.empty() ? "" : ",") + text_of(value);
  std::ranges::replace(name, '/', '_');
  return name.empty() ? "run" : name;
}

void write_curves(const fs::path& folder, const std::vector<FinishedCell>& cells) {
  for (const FinishedCell& cell : cells)
    if (const auto bytes = event_file_of(cell.result); !bytes.empty())
      write_file(folder / cell.stage / run_name(cell.axes) / "events.out.tfevents.0.touchtrace",
                 bytes, true);
}

/// Copies the report of a study that ends in one.
void copy_page(const fs::path& root, const std::vector<FinishedCell>& cells) {
  if (!cells.empty() && cells.back().output.extension() == ".html" && cells.back().axes.empty())
    write_file(root / cells.back().output.filename(), read_file(cells.back().output), true);
}

std::vector<Row> cost_rows(const std::vector<FinishedCell>& cells) {
  std::vector<Row> rows;
  for (const FinishedCell& cell : cells)
    rows.push_back({cell.axes, {{"stage", cell.stage}, {"wall_seconds", cell.wall_seconds}}});
  return rows;
}

/// Columns of the tables that commands propose, `main_metrics` in their results, if any row has
/// numbers there; empty: all.
std::vector<std::string> main_metrics(const std::vector<FinishedCell>& cells,
                                      const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const FinishedCell& cell : cells) {
    if (!cell.result.is_object()) continue;
    for (const auto& name : cell.result.value("main_metrics", ordered_json::array()))
      if (name.is_string() && std::ranges::find(names, name.get<std::string>()) == names.end())
        names.push_back(name);
  }
  std::erase_if(names, [&](const auto& name) {
    return std::ranges::none_of(
        rows, [&](const Row& row) { return row.fields.value(name, ordered_json()).is_number(); });
  });
  return names;
}

ordered_json groups_json(const Summary& summary) {
  auto groups = ordered_json::array();
  for (const auto& group : summary.groups) {
    ordered_json entry{{"n", group.count}};
    for (std::size_t i = 0; i < summary.keys.size(); ++i) entry[summary.keys[i]] = group.keys[i];
    for (std::size_t i = 0; i < summary.metrics.size(); ++i)
      entry[summary.metrics[i]] = {{"mean", group.metrics[i].mean}, {"std", group.metrics[i].std}};
    groups.push_back(std::move(entry));
  }
  return groups;
}

ordered_json combined(const std::vector<Row>& rows, const Summary& summary) {
  auto results = ordered_json::array();
  for (Row row : rows) {
    row.axes.update(row.fields);
    results.push_back(std::move(row.axes));
  }
  return {{"schema", "touchtrace/sweep-metrics/1"},
          {"results", std::move(results)},
          {"summary", groups_json(summary)}};
}

}  // namespace

json collect(const fs::path& root, const std::vector<std::string>& metrics) {
  const auto [cells, missing] = read_finished_cells(root);
  const auto rows = rows_of(cells);
  const auto columns = summarize(rows, metrics.empty() ? main_metrics(cells, rows) : metrics);
  const auto table = markdown_of(columns);
  write_file(root / "results.csv", csv_of(rows), true);
  write_file(root / "seconds.csv", csv_of(cost_rows(cells)), true);
  write_file(root / "metrics.json", combined(rows, summarize(rows, {})).dump(1) + "\n", true);
  write_file(root / "table.md", table, true);
  write_file(root / "table.tex", latex_of(columns), true);
  write_curves(root / "tensorboard", cells);
  copy_page(root, cells);
  return {{"output", root.string()},
          {"rows", rows.size()},
          {"cells", cells.size()},
          {"missing_cells", missing},
          {"table", table}};
}

}  // namespace touchtrace::sweep
