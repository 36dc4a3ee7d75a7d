#pragma once

#include <vector>

#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// What a value of taxel `taxel` of window `window` is multiplied by: 0 or 1 / (1 - share).
double kept(const TaxelDropout& dropout, std::uint32_t taxels, std::uint32_t window,
            std::uint32_t taxel);

/// tactile_window.h in plain loops: [window, frame, row, column] from the stream [frame, row,
/// column].
std::vector<double> tactile_window_reference(const TactileWindowShape& shape,
                                             const std::vector<double>& stream,
                                             const std::vector<int>& last_frame,
                                             const TaxelDropout& dropout);

}  // namespace touchtrace
