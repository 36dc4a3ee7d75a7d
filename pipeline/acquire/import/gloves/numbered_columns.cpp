#include "pipeline/acquire/import/gloves/numbered_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/progress.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_square = 16;  // of numbered columns, where no layout is given

/// Columns next to each other whose names count from one to the next: s_0, s_1, s_2.
struct NumberedRun {
  std::size_t first, count;  ///< into the columns
};

std::vector<NumberedRun> runs_of(const std::vector<TableColumn>& columns) {
  const auto split = [](const std::string& name) {
    const auto digits = name.find_last_not_of("0123456789") + 1;
    std::int64_t number = -1;
    parse_whole(name.substr(digits), number);
    return std::pair(name.substr(0, digits), number);
  };
  std::vector<NumberedRun> runs;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto [words, number] = split(columns[i].label);
    const bool continues = i > 0 && number > 0 && columns[i].index == columns[i - 1].index + 1 &&
                           split(columns[i - 1].label) == std::pair(words, number - 1);
    if (continues)
      ++runs.back().count;
    else
      runs.push_back({i, 1});
  }
  return runs;
}

}  // namespace

bool is_layout(std::size_t values, const GloveFileOptions& options) {
  const auto rows = static_cast<std::size_t>(options.rows),
             cols = static_cast<std::size_t>(options.cols),
             side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(values))));
  if (rows > 0 && cols > 0) return values == rows * cols;
  return rows + cols > 0 ? values % (rows + cols) == 0 : values == side * side;
}

std::string list_of(const std::vector<TableColumn>& columns) {
  constexpr std::size_t max_bytes = 300;
  std::string list;
  for (const auto& [first, count] : runs_of(columns)) {
    if (list.size() > max_bytes) return list + ", ...";
    list += (list.empty() ? "" : ", ") + columns[first].label;
    if (count > 1) list += " to " + columns[first + count - 1].label;
  }
  return list;
}

void keep_numbered(const GloveFileOptions& options, std::vector<TableColumn>& taxels) {
  if (is_layout(taxels.size(), options)) return;
  auto runs = runs_of(taxels);
  std::erase_if(runs, [](const NumberedRun& run) { return run.count < 2; });
  std::vector<std::vector<TableColumn>> candidates(1);
  for (const auto& [first, count] : runs) {
    const auto begin = taxels.begin() + static_cast<std::ptrdiff_t>(first);
    candidates[0].insert(candidates[0].end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    if (runs.size() > 1) candidates.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  const std::size_t min_count = options.rows + options.cols > 0 ? 2 : min_square;
  std::erase_if(candidates, [&](const std::vector<TableColumn>& columns) {
    return columns.size() < min_count || !is_layout(columns.size(), options);
  });
  if (candidates.size() != 1) return;
  Progress::warn(
      fmt::format("glove: of the columns {} only {} are taken for taxels; --taxels "
                  "FIRST:LAST names others",
                  list_of(taxels), list_of(candidates[0])));
  taxels = std::move(candidates[0]);
}

}  // namespace touchtrace
