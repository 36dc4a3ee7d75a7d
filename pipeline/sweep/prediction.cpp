#include "pipeline/sweep/prediction.h"

#include <map>
#include <optional>
#include <set>

#include "engine/base/files.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Cost {
  double seconds = 0.0;
  int cells = 0;
};

/// Mean seconds of finished cells by command.
std::map<std::string, Cost> known_costs(const fs::path& root) {
  std::map<std::string, Cost> costs;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(root / "cells", missing)) {
    const auto file = entry.path() / "seconds.json";
    if (!fs::exists(file)) continue;
    const json seconds = json::parse(read_file(file), nullptr, false);
    const auto id = entry.path().filename().string();
    auto& cost = costs[id.substr(0, id.rfind('-'))];
    cost.seconds += seconds.is_object() ? seconds.value("wall_seconds", 0.0) : 0.0;
    ++cost.cells;
  }
  return costs;
}

json stage_row(const std::string& stage, std::size_t cells, std::size_t done, const json& seconds) {
  return {{"stage", stage}, {"cells", cells}, {"done", done}, {"predicted_seconds", seconds}};
}

}  // namespace

json predict(const std::vector<Cell>& cells, const std::vector<bool>& selected,
             const fs::path& root, std::size_t jobs) {
  const auto costs = known_costs(root);
  json rows = json::array();
  std::set<std::string> counted;
  std::size_t total = 0, total_done = 0;
  std::optional<double> total_s = 0.0;
  for (std::size_t first = 0, end = 0; first < cells.size(); first = end) {
    std::size_t count = 0, done = 0, left = 0;
    for (; end < cells.size() && cells[end].stage == cells[first].stage; ++end) {
      if (!selected[end]) continue;
      const bool is_done = cells[end].is_done();
      ++count, done += is_done;
      left += !is_done && counted.insert(cells[end].id).second;
    }
    const auto cost = costs.find(cells[first].command);
    json seconds = nullptr;
    if (left == 0) seconds = 0.0;
    if (left > 0 && cost != costs.end())
      seconds = static_cast<double>(left) * cost->second.seconds / cost->second.cells /
                static_cast<double>(jobs);
    rows.push_back(stage_row(cells[first].stage, count, done, seconds));
    total += count, total_done += done;
    total_s = total_s && seconds.is_number() ? std::optional(*total_s + seconds.get<double>())
                                             : std::nullopt;
  }
  rows.push_back(stage_row("total", total, total_done, total_s ? json(*total_s) : json()));
  return rows;
}

}  // namespace touchtrace::sweep
