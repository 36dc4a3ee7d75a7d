#include "pipeline/acquire/track_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr const char* axes = "xyz";
constexpr std::size_t max_listed_bytes = 300, max_name_bytes = 64;

std::string shortened(const std::string& text) {
  return text.size() > max_listed_bytes ? text.substr(0, max_listed_bytes) + "..." : text;
}

/// One column for each axis; nullopt if none has any.
std::optional<std::array<TableColumn, 3>> find_sigmas(const TextTable& table,
                                                      const std::vector<std::string>& names) {
  if (const auto all = find_column(table, names, {"sigma"}, length_units()))
    return std::array{*all, *all, *all};
  std::array<std::optional<TableColumn>, 3> found;
  for (std::size_t i = 0; i < 3; ++i)
    found[i] = find_column(table, names, {fmt::format("sigma_{}", axes[i])}, length_units());
  if (!found[0] && !found[1] && !found[2]) return std::nullopt;
  if (!found[0] || !found[1] || !found[2])
    throw data_error(
        fmt::format("{} has standard deviations of some axes only", table.file().string()),
        "give sigma_x_m, sigma_y_m and sigma_z_m, or sigma_m");
  return std::array{*found[0], *found[1], *found[2]};
}

using Names = std::vector<std::string>;
using Triple = std::array<std::size_t, 3>;  ///< columns of x, y and z

/// Whether the axis is that of a rotation, velocity or acceleration.
bool is_other_vector(const std::string& name) {
  static const std::regex other(
      "(^|.*_)[qrvaw][xyz](_.*|$)|.*(quat|rot|orient|euler|angle|vel|acc|sigma|std).*");
  return std::regex_match(name, other);
}

/// Columns of y and z whose names differ from that of column `x` by one letter.
std::optional<Triple> triple_of(const std::string& name, std::size_t x,
                                const std::map<std::string, std::size_t>& columns) {
  for (std::size_t letter = 0; letter < name.size(); ++letter) {
    if (name[letter] != 'x') continue;
    std::string other = name;
    other[letter] = 'y';
    const auto y = columns.find(other);
    other[letter] = 'z';
    const auto z = columns.find(other);
    if (y != columns.end() && z != columns.end()) return Triple{x, y->second, z->second};
  }
  return std::nullopt;
}

/// Positions that the names of columns could mean, or those of the column that the user chose.
std::vector<Triple> find_triples(const Names& names, const std::string& x_column) {
  std::map<std::string, std::size_t> columns;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].size() <= max_name_bytes) columns.emplace(names[i], i);
  std::vector<Triple> triples;
  for (const auto& [name, i] : columns)
    if (x_column.empty() ? !is_other_vector(name) : name == column_name(x_column))
      if (const auto triple = triple_of(name, i, columns)) triples.push_back(*triple);
  std::ranges::sort(triples);
  return triples;
}

std::array<TableColumn, 3> columns_of_triple(const Names& names, const Triple& triple) {
  std::array<TableColumn, 3> columns;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns[axis] = {triple[axis], 1.0, names[triple[axis]]};
    for (const auto& [suffix, per_unit] : length_units())
      if (!suffix.empty() && columns[axis].label.ends_with(suffix))
        columns[axis].per_unit = per_unit;
  }
  return columns;
}

/// Three columns of one body; nullopt if there are none. Throws data_error if there are several.
std::optional<std::array<TableColumn, 3>> find_body(const TextTable& table, const Names& names,
                                                    const std::string& x_column) {
  const auto triples = find_triples(names, x_column);
  if (triples.empty()) return std::nullopt;
  if (triples.size() > 1) {
    Names bodies;
    for (const Triple& triple : triples) bodies.push_back(quoted_field(names[triple[0]]));
    throw data_error(fmt::format("{} has positions of several bodies: {}", table.file().string(),
                                 shortened(comma_separated(bodies))),
                     fmt::format("choose one: --x-column {}", names[triples[0][0]]));
  }
  const auto columns = columns_of_triple(names, triples.front());
  Progress::report(fmt::format("{}: positions are '{}', '{}', '{}'", table.file().string(),
                               columns[0].label, columns[1].label, columns[2].label));
  return columns;
}

/// Columns by their names. Adds the names of columns that are not found to `missing`.
TrackColumns find_columns(const TextTable& table, const Names& names, const TrackOptions& options,
                          Names& missing) {
  TrackColumns columns;
  columns.time = find_column(table, names, {"time", "t", "timestamp"}, time_units());
  if (!columns.time && options.rate_hz == 0.0) missing.emplace_back("time");
  if (columns.time && options.rate_hz > 0.0)
    throw usage_error(fmt::format("{} has the times '{}', which --input-rate would replace",
                                  table.file().string(), columns.time->label),
                      "leave out --input-rate, or rename the column");
  columns.sigma = find_sigmas(table, names);
  std::array<std::optional<TableColumn>, 3> position;
  if (options.x_column.empty())
    for (std::size_t i = 0; i < 3; ++i)
      position[i] = find_column(
          table, names, {std::string(1, axes[i]), fmt::format("t{}", axes[i])}, length_units());
  if (!position[0] && !position[1] && !position[2])
    if (const auto body = find_body(table, names, options.x_column))
      for (std::size_t i = 0; i < 3; ++i) position[i] = (*body)[i];
  for (std::size_t i = 0; i < 3; ++i)
    if (position[i])
      columns.position[i] = *position[i];
    else
      missing.emplace_back(1, axes[i]);
  return columns;
}

/// Columns of a file without a header: time x y z, then standard deviations or a quaternion.
TrackColumns columns_in_order(const TextTable& table) {
  if (const auto n = table.num_columns(); n != 4 && n != 7 && n != 8)
    throw data_error(
        fmt::format("{}: rows without a header have 4 columns (time x y z), 7 (and their standard "
                    "deviations) or 8 (and a quaternion), not {}",
                    table.file().string(), n),
        "add a header line such as time_s,x_m,y_m,z_m");
  TrackColumns columns{TableColumn{0, 1.0, "time"}, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) columns.position[i] = {i + 1, 1.0, std::string(1, axes[i])};
  if (table.num_columns() != 7) return columns;
  columns.sigma.emplace();
  for (std::size_t i = 0; i < 3; ++i)
    (*columns.sigma)[i] = {i + 4, 1.0, fmt::format("sigma_{}", axes[i])};
  return columns;
}

std::string list_of_names(const TextTable& table) {
  Names list;
  for (const auto& name : table.names()) list.push_back(quoted_field(name));
  return shortened(comma_separated(list));
}

}  // namespace

TrackColumns columns_of(const TextTable& table, const TrackOptions& options) {
  std::vector<std::string> missing;
  if (!table.names().empty()) {
    const auto columns = find_columns(table, table.names(), options, missing);
    if (missing.empty()) return columns;
    throw data_error(
        fmt::format("{} has no column for {}; its columns: {}", table.file().string(),
                    comma_separated(missing), list_of_names(table)),
        "name the columns time_s, x_m, y_m, z_m (units: s, ms, us, ns and m, cm, mm), or give "
        "--x-column NAME, and --input-rate HZ for a file without times");
  }
  if (table.comment_names().size() == table.num_columns()) {
    const auto columns = find_columns(table, table.comment_names(), options, missing);
    if (missing.empty()) return columns;
  }
  return columns_in_order(table);
}

}  // namespace touchtrace
