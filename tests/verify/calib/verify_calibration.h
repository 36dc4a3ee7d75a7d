#pragma once

#include "calib/board/chessboard.h"
#include "tests/verify/support/figure.h"

namespace touchtrace {

/// What the same corners come to, through the lenses named, if the board's print is taken for
/// right.
struct IdealBoard {
  double fx, held_out_rms_px;
};

IdealBoard calibrate_with_ideal_board(const BoardObservations& observations,
                                      const std::vector<std::string>& lenses);

/// Simulated boards, 1000 runs a level: NEES, RMSE over the Cramer-Rao bound, seconds.
void verify_simulated_calibration(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
