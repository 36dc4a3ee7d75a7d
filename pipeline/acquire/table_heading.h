#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

using TableLine = std::vector<std::string_view>;  ///< fields of a line

/// Whether the line names the axes of several bodies but not the bodies, as that of Motive, Nexus
/// and .trc files does: "Frame, Time, X, Y, Z, X, Y, Z" or "-, -, X1, Y1, Z1".
bool names_axes_only(const TableLine& line);

/// Names of the columns: of the last line, below bodies and units of those before it. An axis of
/// "Hand, -, -" above "X, Y, Z" is "hand_x", with "Length Units, Millimeters" above it
/// "hand_x_millimeters".
std::vector<std::string> names_of_heading(std::span<const TableLine> lines);

}  // namespace touchtrace
