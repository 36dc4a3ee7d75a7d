#pragma once

#include <string>
#include <vector>

#include "tests/verify/support/figure.h"

namespace touchtrace::report {

/// Renders a plot as SVG: axes with ticks, one line per curve, a legend. Skips points that are not
/// finite, and points <= 0 on a logarithmic axis.
std::string to_svg(const Picture& picture);

/// Renders a self-contained HTML page: the table of `figures`, then their plots.
std::string figures_page(const std::string& title, const std::vector<Figure>& figures);

}  // namespace touchtrace::report
