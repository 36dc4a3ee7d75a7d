#pragma once

#include "calib/rgbd/board_problem.h"

namespace touchtrace {

/// How the board moves in each view, from the poses of the used views just before and after it
/// (within `longest_gap_s` by the colour stamps); at rest where there are none. Only where the
/// board moves does a delay between the streams show.
std::vector<BoardMotion> board_motions(const BoardObservations& observations,
                                       const std::vector<bool>& used,
                                       const RgbdParameters& parameters);

/// True if enough views move for a delay to be estimated.
bool shows_delay(const std::vector<BoardMotion>& motions);

inline constexpr double longest_gap_s = 0.15;

}  // namespace touchtrace
