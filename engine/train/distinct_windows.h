#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/ops/tactile_window.h"

namespace touchtrace {

/// Windows of a stream without duplicates.
struct DistinctWindows {
  std::vector<std::int32_t> window_end;  ///< last frame of each distinct window
  std::vector<std::int32_t> row;         ///< [requested windows] index into window_end
};

/// Removes duplicates: overlapping roll-outs share windows, and windows without contact are often
/// equal. `stream`: [frames, rows, cols]. `window_end`: last frames of the requested windows, which
/// must be inside the stream. `shape.windows` is ignored.
DistinctWindows distinct_windows(std::span<const float> stream, const TactileWindowShape& shape,
                                 std::span<const std::int32_t> window_end);

}  // namespace touchtrace
