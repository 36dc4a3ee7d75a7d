#include "pipeline/acquire/table_units.h"

#include <algorithm>
#include <vector>

namespace touchtrace {
namespace {

/// One row for each spelling.
std::vector<TableUnit> units_of(
    const std::vector<std::pair<double, std::vector<std::string>>>& spellings) {
  std::vector<TableUnit> units{{"", 1.0}};
  for (const auto& [per_unit, names] : spellings)
    for (const auto& name : names) units.push_back({"_" + name, per_unit});
  return units;
}

}  // namespace

std::span<const TableUnit> time_units() {
  static const auto units = units_of({{1.0, {"s", "sec", "secs", "second", "seconds"}},
                                      {1e3, {"ms", "msec", "msecs", "milliseconds"}},
                                      {1e6, {"us", "usec", "usecs", "microseconds"}},
                                      {1e9, {"ns", "nsec", "nsecs", "nanoseconds"}}});
  return units;
}

std::span<const TableUnit> length_units() {
  static const auto units = units_of({{1.0, {"m", "meter", "meters", "metre", "metres"}},
                                      {1e1, {"dm"}},
                                      {1e2, {"cm", "centimeters", "centimetres"}},
                                      {1e3, {"mm", "millimeters", "millimetres"}},
                                      {1e6, {"um", "micrometers", "micrometres"}},
                                      {1e-3, {"km"}},
                                      {1.0 / 0.3048, {"ft", "foot", "feet"}},
                                      {1.0 / 0.0254, {"in", "inch", "inches"}}});
  return units;
}

bool is_unit(std::string_view suffix) {
  const auto has = [&](std::span<const TableUnit> units) {
    return std::ranges::any_of(
        units, [&](const TableUnit& unit) { return !suffix.empty() && unit.suffix == suffix; });
  };
  return has(time_units()) || has(length_units());
}

}  // namespace touchtrace
