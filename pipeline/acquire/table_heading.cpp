#include "pipeline/acquire/table_heading.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

#include "pipeline/acquire/text_table.h"

namespace touchtrace {
namespace {

constexpr std::size_t min_axes = 3, min_identifier_bytes = 16;

/// x, y or z, perhaps with a number behind it.
bool is_axis(const std::string& name) {
  return !name.empty() && name[0] >= 'x' && name[0] <= 'z' &&
         std::all_of(name.begin() + 1, name.end(), [](unsigned char c) { return std::isdigit(c); });
}

bool is_number_or_identifier(std::string_view field) {
  const auto is_hexadecimal = [](unsigned char c) { return std::isxdigit(c); };
  return (!field.empty() && parse_number<double>(field, true)) ||
         (field.size() >= min_identifier_bytes && std::ranges::all_of(field, is_hexadecimal));
}

bool is_unit_label(std::string_view field) {
  const std::string name = column_name(field);
  return name == "units" || name == "length_units";
}

/// Whether the line names bodies or quantities of the columns below it, behind those of frame and
/// time.
bool names_columns(const TableLine& line, std::size_t columns) {
  return line.size() > 2 && 2 * line.size() > columns &&
         std::any_of(line.begin() + 2, line.end(), [](auto field) { return !field.empty(); }) &&
         std::ranges::none_of(line, is_number_or_identifier) &&
         std::ranges::none_of(line, is_unit_label);
}

/// Unit of lengths: behind "Length Units" or below "Units".
std::optional<std::string> length_unit(std::span<const TableLine> lines) {
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t k = 0; k < lines[i].size(); ++k) {
      const std::string name = column_name(lines[i][k]);
      if (name == "length_units" && k + 1 < lines[i].size()) return column_name(lines[i][k + 1]);
      if (name == "units" && i + 1 < lines.size() && k < lines[i + 1].size())
        return column_name(lines[i + 1][k]);
    }
  return std::nullopt;
}

void append(std::string& name, const std::string& word) {
  if (!name.empty() && !word.empty()) name += '_';
  name += word;
}

/// Names of the lines above a column, where an empty field stands for the one to its left.
std::vector<std::string> names_above(std::span<const TableLine> lines, std::size_t columns) {
  std::vector<std::string> names(columns);
  for (const TableLine& line : lines) {
    if (!names_columns(line, columns)) continue;
    std::string last;
    for (std::size_t i = 0; i < columns; ++i) {
      if (i < line.size() && !line[i].empty()) last = column_name(line[i]);
      append(names[i], last);
    }
  }
  return names;
}

}  // namespace

bool names_axes_only(const TableLine& line) {
  std::set<std::string> axes;
  std::size_t count = 0, unnamed = 0;
  for (const auto field : line) {
    const std::string name = column_name(field);
    if (is_axis(name)) axes.insert(name), ++count;
    unnamed += field.empty();
  }
  return count >= min_axes && (axes.size() < count || (unnamed > 0 && !axes.contains("x")));
}

std::vector<std::string> names_of_heading(std::span<const TableLine> lines) {
  const TableLine& line = lines.back();
  const auto above = names_above(lines.first(lines.size() - 1), line.size());
  const std::string unit = length_unit(lines).value_or("");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::string own = column_name(line[i]);
    std::string name = own.empty() || is_axis(own) ? above[i] : "";
    append(name, own);
    if (is_axis(own)) append(name, unit);
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace touchtrace
