#include "pipeline/sweep/manifest.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* schema = "touchtrace/sweep/1";

ordered_json parse(const fs::path& file) {
  auto document = ordered_json::parse(read_file(file), nullptr, false);
  if (!document.is_discarded()) return document;
  throw data_error(fmt::format("{} is not JSON", file.string()),
                   "delete its folder and run the sweep again");
}

FinishedCell read_cell(const fs::path& folder, const ordered_json& entry) {
  FinishedCell cell{entry.at("stage"), entry.at("axes"), parse(folder / "result.json"), 0.0,
                    folder / entry.at("output").get<std::string>()};
  if (const auto file = folder / "seconds.json"; fs::exists(file))
    cell.wall_seconds = parse(file).value("wall_seconds", 0.0);
  return cell;
}

}  // namespace

void write_manifest(const fs::path& root, const std::vector<Cell>& cells) {
  json entries = json::array();
  for (const Cell& cell : cells)
    entries.push_back({{"id", cell.id},
                       {"stage", cell.stage},
                       {"axes", cell.axes},
                       {"output", cell.output.filename().string()}});
  write_file(root / "study.json", json{{"schema", schema}, {"cells", entries}}.dump(1) + "\n",
             true);
}

FinishedCells read_finished_cells(const fs::path& root) {
  const auto file = root / "study.json";
  if (!fs::exists(file))
    throw data_error(
        fmt::format("{} is not the folder of a sweep: it has no study.json", root.string()),
        "give the --output of `touchtrace sweep`");
  const auto document = parse(file);
  FinishedCells finished;
  try {
    for (const auto& entry : document.at("cells")) {
      const auto folder = root / "cells" / entry.at("id").get<std::string>();
      if (fs::exists(folder / "result.json"))
        finished.cells.push_back(read_cell(folder, entry));
      else
        ++finished.missing;
    }
  } catch (const nlohmann::json::exception& error) {
    throw data_error(fmt::format("{} is damaged: {}", file.string(), error.what()),
                     "run the sweep again");
  }
  return finished;
}

}  // namespace touchtrace::sweep
