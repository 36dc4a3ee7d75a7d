#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/sweep/cells.h"

namespace touchtrace::sweep {

/// Writes `root`/study.json: the cells of the last study that was run in this folder.
void write_manifest(const std::filesystem::path& root, const std::vector<Cell>& cells);

/// Result of a finished cell.
struct FinishedCell {
  std::string stage;
  nlohmann::ordered_json axes, result;
  double wall_seconds = 0.0;
  std::filesystem::path output;
};

struct FinishedCells {
  std::vector<FinishedCell> cells;
  std::size_t missing = 0;  ///< cells of the study that are not done
};

/// Reads the finished cells of `root`/study.json. Throws data_error for what is not a sweep's
/// folder.
FinishedCells read_finished_cells(const std::filesystem::path& root);

}  // namespace touchtrace::sweep
