#pragma once

#include "calib/board/chessboard.h"
#include "tests/verify/support/figure.h"

namespace touchtrace {

/// Calibration without per-corner deformation.
struct IdealBoard {
  double fx, held_out_rms_px;
};

/// `lenses`: as CalibrationOptions::lenses.
IdealBoard calibrate_with_ideal_board(const BoardObservations& observations,
                                      const std::vector<std::string>& lenses);

/// Measures calibrations of simulated boards, 1000 runs a noise level: NEES, RMSE over the
/// Cramer-Rao bound, CPU time.
void verify_simulated_calibration(const std::function<void(Figure)>& emit);

}  // namespace touchtrace
