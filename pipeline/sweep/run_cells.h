#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/cells.h"

namespace touchtrace::sweep {

/// Part `index` of `count` of every stage's cells, with the cells that these need.
struct Shard {
  std::size_t index = 0, count = 1;
};

/// Shard of a text "I/N", I from 1 to N. Throws usage_error.
Shard parse_shard(const std::string& text);

/// Whether each cell belongs to the shard.
std::vector<bool> cells_of(const Shard& shard, const std::vector<Cell>& cells);

struct SweepSummary {
  std::size_t reused = 0, done = 0, failed = 0;
  std::size_t skipped = 0;  ///< an input has failed
};

/// Runs the selected cells that are not done, in child processes of this program, at most `jobs` at
/// a time. Prints the messages of those that fail, and runs the others to the end. Other processes
/// may run cells of the same folder. An interrupt ends the children and is thrown.
SweepSummary run_cells(const std::vector<Cell>& cells, const std::vector<bool>& selected,
                       std::size_t jobs);

/// Prints the message of a failed cell on stderr.
void report_failed(const Cell& cell);

}  // namespace touchtrace::sweep
