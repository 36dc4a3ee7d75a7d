#pragma once

#include <string>
#include <vector>

#include "tests/verify/support/figure.h"

namespace touchtrace::report {

/// The picture as SVG: axes with ticks, one line a curve, a legend. Points that are not finite, or
/// not positive on a logarithmic axis, are left out.
std::string svg_of(const Picture& picture);

/// One self-contained HTML page: the table of `figures` and their pictures.
std::string figures_page(const std::string& title, const std::vector<Figure>& figures);

}  // namespace touchtrace::report
