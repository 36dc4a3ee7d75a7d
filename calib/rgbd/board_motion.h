#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// Returns the board's velocity in each view [views], from the poses of the nearest used views
/// before and after it. Zero where there is none within `max_gap_s` by colour time stamps.
std::vector<BoardMotion> board_motions(const BoardObservations& observations,
                                       const std::vector<bool>& used,
                                       const RgbdParameters& parameters);

/// True if the board moves in enough views to estimate the delay between depth and colour.
bool is_delay_observable(const std::vector<BoardMotion>& motions);

inline constexpr double max_gap_s = 0.15;

}  // namespace touchtrace
