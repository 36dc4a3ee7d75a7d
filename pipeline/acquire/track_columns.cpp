#include "pipeline/acquire/track_columns.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr const char* axes = "xyz";
constexpr std::size_t max_listed_bytes = 300;

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

/// Columns by their names. Adds the names of columns that are not found to `missing`.
TrackColumns find_columns(const TextTable& table, const std::vector<std::string>& names,
                          std::vector<std::string>& missing) {
  TrackColumns columns;
  const auto require = [&](TableColumn& column, std::vector<std::string> any,
                           std::span<const TableUnit> units) {
    if (const auto found = find_column(table, names, any, units))
      column = *found;
    else
      missing.push_back(any.front());
  };
  require(columns.time, {"time", "t", "timestamp"}, time_units());
  for (std::size_t i = 0; i < 3; ++i)
    require(columns.position[i], {std::string(1, axes[i]), fmt::format("t{}", axes[i])},
            length_units());
  columns.sigma = find_sigmas(table, names);
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
  TrackColumns columns{{0, 1.0, "time"}, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) columns.position[i] = {i + 1, 1.0, std::string(1, axes[i])};
  if (table.num_columns() != 7) return columns;
  columns.sigma.emplace();
  for (std::size_t i = 0; i < 3; ++i)
    (*columns.sigma)[i] = {i + 4, 1.0, fmt::format("sigma_{}", axes[i])};
  return columns;
}

std::string list_of_names(const TextTable& table) {
  std::string list;
  for (const auto& name : table.names()) {
    list += (list.empty() ? "" : ", ") + quoted_field(name);
    if (list.size() > max_listed_bytes) return list + ", ...";
  }
  return list;
}

}  // namespace

TrackColumns columns_of(const TextTable& table) {
  std::vector<std::string> missing;
  if (!table.names().empty()) {
    const auto columns = find_columns(table, table.names(), missing);
    if (missing.empty()) return columns;
    throw data_error(fmt::format("{} has no column for {}; its columns: {}", table.file().string(),
                                 comma_separated(missing), list_of_names(table)),
                     "name the columns time_s, x_m, y_m, z_m; units: s, ms, us, ns and m, cm, mm");
  }
  if (table.comment_names().size() == table.num_columns()) {
    const auto columns = find_columns(table, table.comment_names(), missing);
    if (missing.empty()) return columns;
  }
  return columns_in_order(table);
}

}  // namespace touchtrace
