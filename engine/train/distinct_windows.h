#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// Windows of a stream of which no two are equal, and which of them each window asked for is.
struct DistinctWindows {
  std::vector<std::int32_t> last_frame;  ///< of each
  std::vector<std::int32_t> row;         ///< [windows asked for], into last_frame
};

/// Roll-outs that overlap share windows, and windows without contact may be equal anywhere in the
/// stream. `stream`: [frames, rows, cols]; `last_frame`: of the windows asked for, all inside it;
/// of `shape`, the number of windows does not matter.
DistinctWindows distinct_windows(std::span<const float> stream, const TactileWindowShape& shape,
                                 std::span<const std::int32_t> last_frame);

}  // namespace touchtrace
