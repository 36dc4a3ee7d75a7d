#include "pipeline/acquire/import/gloves/taxel_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <regex>
#include <set>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_name_bytes = 64;

struct TaxelName {
  std::string words;  ///< before the numbers
  int row, col;       ///< row is -1 of names with one number
};

std::optional<TaxelName> parse_name(const std::string& name) {
  static const std::regex pattern("(.*?)(?:([0-9]{1,4})_)?([0-9]{1,7})");
  std::smatch match;
  if (name.size() > max_name_bytes || !std::regex_match(name, match, pattern)) return std::nullopt;
  return TaxelName{match[1], match[2].matched ? std::stoi(match[2]) : -1, std::stoi(match[3])};
}

/// Parsed names; empty unless all have the same words and as many numbers.
std::vector<TaxelName> parse_names(const std::vector<std::string>& names) {
  std::vector<TaxelName> parsed;
  for (const auto& name : names) {
    const auto taxel = parse_name(name);
    if (!taxel) return {};
    if (!parsed.empty() &&
        (taxel->words != parsed[0].words || (taxel->row < 0) != (parsed[0].row < 0)))
      return {};
    parsed.push_back(*taxel);
  }
  return parsed;
}

/// Column of a taxel.
std::size_t column_of(const std::vector<TaxelName>& taxels, int row, int col,
                      const std::filesystem::path& file) {
  const auto is_taxel = [&](const TaxelName& t) { return t.row == row && t.col == col; };
  const auto found = std::ranges::find_if(taxels, is_taxel);
  const std::string name = fmt::format("{}{}_{}", taxels[0].words, row, col);
  if (found == taxels.end())
    throw data_error(fmt::format("{} has no column '{}'", file.string(), name),
                     "names ROW_COL must name each taxel of the layout: add a column of zeros");
  if (std::find_if(found + 1, taxels.end(), is_taxel) != taxels.end())
    throw data_error(fmt::format("{} has two columns '{}'", file.string(), name),
                     "rename one of them");
  return static_cast<std::size_t>(found - taxels.begin());
}

void report(const NamedLayout& layout, int first) {
  const bool is_ordered = std::ranges::is_sorted(layout.column);
  if (is_ordered && first == 0) return;
  Progress::report(fmt::format("glove: {} x {} taxels by the names of the columns{}{}", layout.rows,
                               layout.cols, first == 1 ? ", counted from 1" : "",
                               is_ordered ? "" : ", which are not row by row"));
}

/// Whether names ROW_COL name each taxel of a rectangle once.
bool is_complete(const std::vector<TaxelName>& taxels) {
  std::set<std::pair<int, int>> places;
  for (const TaxelName& taxel : taxels) places.insert({taxel.row, taxel.col});
  const auto [min_row, max_row] = std::ranges::minmax(taxels, {}, &TaxelName::row);
  const auto [min_col, max_col] = std::ranges::minmax(taxels, {}, &TaxelName::col);
  const auto count = [](int from, int to) { return static_cast<std::size_t>(to - from + 1); };
  return places.size() == taxels.size() &&
         places.size() == count(min_row.row, max_row.row) * count(min_col.col, max_col.col) &&
         std::max(min_row.row, min_col.col) <= 1;
}

NamedLayout grid(const std::vector<TaxelName>& taxels, const std::filesystem::path& file) {
  const auto [min_row, max_row] = std::ranges::minmax(taxels, {}, &TaxelName::row);
  const auto [min_col, max_col] = std::ranges::minmax(taxels, {}, &TaxelName::col);
  const int first = min_row.row == 1 && min_col.col == 1 ? 1 : 0;
  NamedLayout layout{max_row.row - first + 1, max_col.col - first + 1, {}};
  for (int row = first; row <= max_row.row; ++row)
    for (int col = first; col <= max_col.col; ++col)
      layout.column.push_back(column_of(taxels, row, col, file));
  report(layout, first);
  return layout;
}

}  // namespace

NamedLayout named_layout(const std::vector<std::string>& names, const std::filesystem::path& file) {
  const auto taxels = parse_names(names);
  const bool is_grid = !taxels.empty() && taxels[0].row >= 0;
  const bool is_ours = is_grid && (taxels[0].words.empty() || taxels[0].words == "counts_");
  if (is_ours || (is_grid && is_complete(taxels))) return grid(taxels, file);
  NamedLayout layout{0, 0, std::vector<std::size_t>(names.size())};
  std::iota(layout.column.begin(), layout.column.end(), std::size_t{0});
  if (taxels.empty() || is_grid || std::ranges::is_sorted(taxels, {}, &TaxelName::col))
    return layout;
  std::set<int> numbers;
  for (const TaxelName& taxel : taxels) numbers.insert(taxel.col);
  if (numbers.size() < taxels.size()) return layout;
  std::ranges::sort(layout.column, {}, [&](std::size_t i) { return taxels[i].col; });
  Progress::report("glove: taxels are put in the order of the numbers of their columns");
  return layout;
}

}  // namespace touchtrace
