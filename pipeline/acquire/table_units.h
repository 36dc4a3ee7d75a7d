#pragma once

#include <span>
#include <string>
#include <string_view>

namespace touchtrace {

/// Unit by the suffix of a column's name: "_ms" has 1000 per second.
struct TableUnit {
  std::string suffix;
  double per_unit;
};

/// Seconds by default, or s, ms, us, ns.
std::span<const TableUnit> time_units();
/// Metres by default, or m, cm, mm, um, ..., feet and inches.
std::span<const TableUnit> length_units();
/// Whether it is the suffix of a time or a length.
bool is_unit(std::string_view suffix);

}  // namespace touchtrace
